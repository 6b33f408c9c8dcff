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

QString DevsegFilterPlugin::filterName(FilterIDType filter) const {
    return to_qstring(declaration(filter).menu_name);
}

QString DevsegFilterPlugin::filterScriptFunctionName(FilterIDType filter) {
    return to_qstring(declaration(filter).python_name);
}

QString DevsegFilterPlugin::filterInfo(FilterIDType filter) const {
    return to_qstring(declaration(filter).help);
}

MeshFilterInterface::FilterClass DevsegFilterPlugin::getClass(QAction* action) {
    return devseg::host::filter_class<MeshFilterInterface>(declaration(ID(action)));
}

MeshFilterInterface::FILTER_ARITY DevsegFilterPlugin::filterArity(QAction*) const {
    return MeshFilterInterface::SINGLE_MESH;
}

int DevsegFilterPlugin::getPreConditions(QAction*) const {
    return MeshModel::MM_NONE; // the input gate says more than a greyed-out menu entry
}

int DevsegFilterPlugin::postCondition(QAction* action) const {
    return devseg::host::written_elements(declaration(ID(action)));
}

void DevsegFilterPlugin::initParameterSet(QAction* action, MeshDocument&,
                                          RichParameterList& parameters) {
    parameters = devseg::host::rich_parameters(declaration(ID(action)));
}

// Nothing in this host catches an exception: failures are told by the return value. The window
// shows errorMessage, the batch server prints nothing but the log.
bool DevsegFilterPlugin::applyFilter(QAction* action, MeshDocument& document,
                                     const RichParameterList& parameters,
                                     vcg::CallBackPos* callback) {
    errorMessage.clear();
    try {
        const devseg::host::HostRun run =
            devseg::host::run_in_host(declaration(ID(action)), document, parameters, callback);
        for (const std::string& line : run.log)
            Log(GLLogStream::FILTER, line);
        return true;
    } catch (const devseg::host::HostError& error) {
        errorMessage = to_qstring(error.what());
        Log(GLLogStream::WARNING, std::string("error: ") + error.what());
        return false;
    }
}
