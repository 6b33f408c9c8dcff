#include "filter_devseg.h"

#include "filters/export_filter.h"
#include "host/filter_host.h"
#include "host/host_errors.h"
#include "host/rich_parameters.h"

namespace {

using devseg::host::to_qstring;

const devseg::declare::FilterDeclaration& declaration(int filter) {
    return devseg::exporting::plugin_filters().at(static_cast<std::size_t>(filter));
}

QVariant to_variant(const devseg::declare::ResultValue& value) {
    if (const auto* values = std::get_if<std::vector<double>>(&value)) {
        Eigen::VectorXd vector(static_cast<Eigen::Index>(values->size()));
        for (std::size_t i = 0; i < values->size(); ++i)
            vector[static_cast<Eigen::Index>(i)] = (*values)[i];
        return QVariant::fromValue(vector);
    }
    if (const auto* truth = std::get_if<bool>(&value))
        return QVariant(*truth);
    if (const auto* count = std::get_if<int>(&value))
        return QVariant(*count);
    return QVariant(std::get<double>(value));
}

} // namespace

DevsegFilterPlugin::DevsegFilterPlugin() {
    const int count = static_cast<int>(devseg::exporting::plugin_filters().size());
    for (int filter = 0; filter < count; ++filter) {
        typeList.push_back(filter);
        actionList.push_back(new QAction(filterName(filter), this));
    }
}

QString DevsegFilterPlugin::pluginName() const {
    return "FilterDevseg";
}

QString DevsegFilterPlugin::vendor() const {
    return "devseg";
}

QString DevsegFilterPlugin::filterName(ActionIDType filter) const {
    return to_qstring(declaration(filter).menu_name);
}

QString DevsegFilterPlugin::pythonFilterName(ActionIDType filter) const {
    return to_qstring(declaration(filter).python_name);
}

QString DevsegFilterPlugin::filterInfo(ActionIDType filter) const {
    return to_qstring(declaration(filter).help);
}

FilterPlugin::FilterClass DevsegFilterPlugin::getClass(const QAction* action) const {
    return devseg::host::filter_class<FilterPlugin>(declaration(ID(action)));
}

FilterPlugin::FilterArity DevsegFilterPlugin::filterArity(const QAction*) const {
    return FilterPlugin::SINGLE_MESH;
}

int DevsegFilterPlugin::getPreConditions(const QAction*) const {
    return MeshModel::MM_NONE; // the input gate says more than a greyed-out menu entry
}

int DevsegFilterPlugin::postCondition(const QAction* action) const {
    return devseg::host::written_elements(declaration(ID(action)));
}

RichParameterList DevsegFilterPlugin::initParameterList(const QAction* action, const MeshModel&) {
    return devseg::host::rich_parameters(declaration(ID(action)));
}

std::map<std::string, QVariant> DevsegFilterPlugin::applyFilter(const QAction* action,
                                                                const RichParameterList& parameters,
                                                                MeshDocument& document,
                                                                unsigned int& post_condition_mask,
                                                                vcg::CallBackPos* callback) {
    try {
        const devseg::host::HostRun run =
            devseg::host::run_in_host(declaration(ID(action)), document, parameters, callback);
        post_condition_mask = run.changed;
        for (const std::string& line : run.log)
            log(line);
        std::map<std::string, QVariant> returned;
        for (const auto& [name, value] : run.values)
            returned[name] = to_variant(value);
        return returned;
    } catch (const devseg::host::HostError& error) {
        throw MLException(to_qstring(error.what()));
    }
}
