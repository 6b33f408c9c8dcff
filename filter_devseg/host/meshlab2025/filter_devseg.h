// The filter plugin for the plugin interface of MeshLab 2022.02 and later, and PyMeshLab.
#pragma once

#include <QObject>

#include <common/plugins/interfaces/filter_plugin.h>

#include "devseg/declare/filter.h"

class DevsegFilterPlugin : public QObject, public FilterPlugin {
    Q_OBJECT
    MESHLAB_PLUGIN_IID_EXPORTER(FILTER_PLUGIN_IID)
    Q_INTERFACES(FilterPlugin)

public:
    DevsegFilterPlugin();

    QString pluginName() const override;
    QString vendor() const override;
    QString filterName(ActionIDType filter) const override;
    QString pythonFilterName(ActionIDType filter) const override;
    QString filterInfo(ActionIDType filter) const override;
    FilterClass getClass(const QAction* action) const override;
    FilterArity filterArity(const QAction* action) const override;
    int getPreConditions(const QAction* action) const override;
    int postCondition(const QAction* action) const override;
    RichParameterList initParameterList(const QAction* action, const MeshModel& mesh) override;
    std::map<std::string, QVariant>
    applyFilter(const QAction* action, const RichParameterList& parameters, MeshDocument& document,
                unsigned int& post_condition_mask, vcg::CallBackPos* callback) override;
};
