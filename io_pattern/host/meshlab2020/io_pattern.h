// The IO plugin for the plugin interface of MeshLab 2020.09, its batch server included: saves the
// pattern of a mesh with texture coordinates.
#pragma once

#include <QObject>

#include <common/interfaces.h>

class PatternIOPlugin : public QObject, public MeshIOInterface {
    Q_OBJECT
    MESHLAB_PLUGIN_IID_EXPORTER(MESH_IO_INTERFACE_IID)
    Q_INTERFACES(MeshIOInterface)

public:
    QString pluginName() const override;
    QList<Format> importFormats() const override;
    QList<Format> exportFormats() const override;
    void GetExportMaskCapability(QString& format, int& capability,
                                 int& default_bits) const override;
    void initSaveParameter(const QString& format, MeshModel& model,
                           RichParameterList& parameters) override;
    bool open(const QString& format, const QString& file_name, MeshModel& model, int& mask,
              const RichParameterList& parameters, vcg::CallBackPos* callback,
              QWidget* parent) override;
    bool save(const QString& format, const QString& file_name, MeshModel& model, int mask,
              const RichParameterList& parameters, vcg::CallBackPos* callback,
              QWidget* parent) override;

private:
    bool fail(const QString& message);
};
