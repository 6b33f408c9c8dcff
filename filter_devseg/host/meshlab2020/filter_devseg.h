// The filter plugin for the plugin interface of MeshLab 2020.09, its batch server included.
#pragma once

#include <QObject>

#include <common/interfaces.h>

class DevsegFilterPlugin : public QObject, public MeshFilterInterface {
    Q_OBJECT
    MESHLAB_PLUGIN_IID_EXPORTER(MESH_FILTER_INTERFACE_IID)
    Q_INTERFACES(MeshFilterInterface)

public:
    DevsegFilterPlugin();

    QString pluginName() const override;
    QString filterName(FilterIDType filter) const override;
    QString filterScriptFunctionName(FilterIDType filter) override;
    QString filterInfo(FilterIDType filter) const override;
    FilterClass getClass(QAction* action) override;
    FILTER_ARITY filterArity(QAction* action) const override;
    int getPreConditions(QAction* action) const override;
    int postCondition(QAction* action) const override;
    void initParameterSet(QAction* action, MeshDocument& document,
                          RichParameterList& parameters) override;
    bool applyFilter(QAction* action, MeshDocument& document, const RichParameterList& parameters,
                     vcg::CallBackPos* callback) override;

private:
    // Each declares one more, that only forwards here.
    using MeshFilterInterface::filterInfo;
    using MeshFilterInterface::filterName;
    using MeshFilterInterface::initParameterSet;
};
