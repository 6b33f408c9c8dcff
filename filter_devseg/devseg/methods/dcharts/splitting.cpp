#include "devseg/methods/dcharts/splitting.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/atlas/fragments.h"
#include "devseg/methods/baselines/vsa.h"
#include "devseg/methods/growth/expansion.h"

namespace devseg::dcharts {

namespace {

constexpr double fragment_share = 0.05; // of the chart: smaller parts are not worth a chart

Index count_labels(const std::vector<Index>& label) {
    return 1 + *std::max_element(label.begin(), label.end());
}

Mesh mesh_of_chart(const Mesh& mesh, const std::vector<Index>& faces) {
    const std::vector<std::uint8_t> no_cuts(mesh.twin.size(), 0);
    return atlas::mesh_of(
        mesh, atlas::extract_surface(mesh, faces, atlas::enclose(mesh, faces, no_cuts)));
}

// Label 0 keeps the chart's number. False where there is just one.
bool take_apart(const Mesh& mesh, const std::vector<Index>& label, double wanted_l2, Index chart,
                Draft& draft, Progress& progress) {
    const Index count = count_labels(label);
    if (count < 2)
        return false;
    const std::vector<Index> faces = std::move(draft.faces[chart]);
    const Index first_new = static_cast<Index>(draft.faces.size());
    draft.faces[chart].clear();
    draft.faces.resize(draft.faces.size() + at(count - 1));
    draft.map.resize(draft.faces.size());
    for (std::size_t i = 0; i < faces.size(); ++i) {
        const Index c = label[i] == 0 ? chart : first_new + label[i] - 1;
        draft.chart[faces[i]] = c;
        draft.faces[c].push_back(faces[i]);
        for (const HalfEdge h : half_edges_of(faces[i]))
            draft.seam[h] = 0;
    }
    judge::TrialEffort effort;
    effort.wanted_l2 = wanted_l2;
    for (Index l = 0; l < count; ++l) {
        const std::size_t c = at(l == 0 ? chart : first_new + l - 1);
        draft.map[c] = judge::try_chart(mesh, draft.faces[c], draft.seam, effort, progress);
    }
    return true;
}

} // namespace

bool split_chart(const Mesh& mesh, const DChartsOptions& options, double wanted_l2, Index chart,
                 Draft& draft, Progress& progress) {
    if (draft.faces[chart].size() < 2)
        return false;
    const Mesh part = mesh_of_chart(mesh, draft.faces[chart]);
    DChartsOptions two = options;
    two.charts_number = 2;
    const DChartsResult grown = segment_dcharts(part, two, progress);
    std::vector<Index> label = grown.chart;
    growth::ExpansionOptions expansion;
    expansion.max_fitting_error = options.max_fitting_error;
    growth::relabel_by_expansion(part, grown.proxies, expansion, label, progress);
    label = atlas::absorb_fragments(part, label, fragment_share);
    if (count_labels(label) < 2) // the shortest border is none: take the charts as they grew
        label = atlas::absorb_fragments(part, grown.chart, fragment_share);
    return take_apart(mesh, label, wanted_l2, chart, draft, progress);
}

bool halve_chart(const Mesh& mesh, double wanted_l2, Index chart, Draft& draft,
                 Progress& progress) {
    if (draft.faces[chart].size() < 2)
        return false;
    baselines::VsaOptions planes;
    planes.charts_number = 2;
    const Mesh part = mesh_of_chart(mesh, draft.faces[chart]);
    return take_apart(mesh, baselines::segment_vsa(part, planes, progress).chart, wanted_l2, chart,
                      draft, progress);
}

} // namespace devseg::dcharts
