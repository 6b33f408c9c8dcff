#include "host/pattern_export.h"

#include <algorithm>

#include "filters/export_filter.h"
#include "host/host_errors.h"
#include "host/layout_uv.h"
#include "host/rich_parameters.h"

namespace devseg {

namespace {

// The file's name is asked for by the host itself.
FilterDeclaration without_file() {
    FilterDeclaration filter = export_filter();
    std::vector<Parameter>& parameters = filter.parameters;
    parameters.erase(
        std::remove_if(parameters.begin(), parameters.end(),
                       [](const Parameter& p) { return p.kind == ParameterKind::output_file; }),
        parameters.end());
    return filter;
}

} // namespace

RichParameterList pattern_parameters() {
    return rich_parameters(without_file());
}

std::vector<std::string> save_pattern(const std::string& file_name, MeshModel& model,
                                      const RichParameterList& parameters,
                                      vcg::CallBackPos* callback) {
    Progress progress([callback](double fraction, const char* phase) {
        return callback == nullptr || callback(static_cast<int>(100.0 * fraction), phase);
    });
    return with_host_errors(model, [&] {
        ParameterValues values = parameter_values(without_file(), parameters);
        values["output_file"] = file_name;
        HostMesh host = read_host_mesh(model);
        host.wedge_uv = read_layout_uv(model);
        return run_filter(export_filter(), host, values, progress).notes;
    });
}

} // namespace devseg
