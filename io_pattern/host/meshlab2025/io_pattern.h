// The IO plugin for the plugin interface of MeshLab 2022.02 and later, and PyMeshLab: saves the
// pattern of a mesh with texture coordinates.
#pragma once

#include <QObject>

#include <common/ml_document/mesh_model.h>
#include <common/plugins/interfaces/io_plugin.h>

class PatternIOPlugin : public QObject, public IOPlugin {
    Q_OBJECT
    MESHLAB_PLUGIN_IID_EXPORTER(IO_PLUGIN_IID)
    Q_INTERFACES(IOPlugin)

public:
    QString pluginName() const override;
    QString vendor() const override;
    std::list<FileFormat> importFormats() const override;
    std::list<FileFormat> exportFormats() const override;
    void exportMaskCapability(const QString& format, int& capability,
                              int& default_bits) const override;
    RichParameterList initSaveParameter(const QString& format,
                                        const MeshModel& model) const override;
    void open(const QString& format, const QString& file_name, MeshModel& model, int& mask,
              const RichParameterList& parameters, vcg::CallBackPos* callback) override;
    void save(const QString& format, const QString& file_name, MeshModel& model, int mask,
              const RichParameterList& parameters, vcg::CallBackPos* callback) override;
};
