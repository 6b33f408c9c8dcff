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

// What the dialog of 'Save as' asks for; the rest is left to the export filter. The host shows one
// row for each and does not scroll, and a laptop's screen has room for some twenty.
constexpr std::array<const char*, 19> asked_for = {
    "mm_per_unit",
    "height_mm",
    "preset",
    "seam_allowance_mm",
    "hem_allowance_mm",
    "notch_spacing_mm",
    "glue_tabs",
    "fold_lines",
    "page",
    "tiling",
    "fit_page",
    "cover",
    "labels",
    "edge_numbers",
    "grain_line",
    "mirror",
    "material",
    "kerf_mm",
    "fabric_width_mm",
};

// The file's name is asked for by the host itself.
declare::FilterDeclaration saving() {
    declare::FilterDeclaration filter = exporting::export_filter();
    std::vector<declare::Parameter>& parameters = filter.parameters;
    const auto is_left_out = [](const declare::Parameter& p) {
        return std::find(asked_for.begin(), asked_for.end(), p.name) == asked_for.end();
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
