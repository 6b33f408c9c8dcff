#include "host/pattern_export.h"

#include <algorithm>
#include <array>
#include <utility>

#include "filters/export_filter.h"
#include "host/host_errors.h"
#include "host/layout_uv.h"
#include "host/rich_parameters.h"

namespace devseg::host {

namespace {

// Options that the dialog of 'Save as' leaves to the export filter: the host shows one row for each
// and does not scroll, and a screen has no room for all.
constexpr std::array<const char*, 18> left_to_the_filter = {
    "max_piece_mm",
    "curve_mm",
    "simplify_mm",
    "corner_style",
    "match_seams",
    "tab_depth_mm",
    "dxf_kind",
    "weld",
    "group",
    "step_numbers",
    "text",
    "sewing_mm_per_minute",
    "stuffing_g_per_litre",
    "frame",
    "scale_check",
    "texture",
    "bleed_mm",
    "registration_marks",
};

// The file's name is asked for by the host itself.
declare::FilterDeclaration saving() {
    declare::FilterDeclaration filter = exporting::export_filter();
    std::vector<declare::Parameter>& parameters = filter.parameters;
    const auto is_left_out = [](const declare::Parameter& p) {
        return p.kind == declare::ParameterKind::output_file ||
               std::find(left_to_the_filter.begin(), left_to_the_filter.end(), p.name) !=
                   left_to_the_filter.end();
    };
    parameters.erase(std::remove_if(parameters.begin(), parameters.end(), is_left_out),
                     parameters.end());
    return filter;
}

} // namespace

RichParameterList pattern_parameters() {
    return rich_parameters(saving());
}

std::vector<std::string> save_pattern(const std::string& file_name, MeshModel& model,
                                      const RichParameterList& parameters,
                                      vcg::CallBackPos* callback) {
    Progress progress([callback](double fraction, const char* phase) {
        return callback == nullptr || callback(static_cast<int>(100.0 * fraction), phase);
    });
    return with_host_errors(model, [&] {
        declare::ParameterValues values = parameter_values(saving(), parameters);
        values["output_file"] = file_name;
        declare::HostMesh host = read_host_mesh(model);
        host.wedge_uv = read_layout_uv(model);
        return declare::run_filter(exporting::export_filter(), std::move(host), values, progress)
            .notes;
    });
}

} // namespace devseg::host
