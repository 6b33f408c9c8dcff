#include "devseg/methods/dcharts/coarse_trials.h"

#include <algorithm>
#include <utility>

#include "devseg/methods/dcharts/joined_turns.h"
#include "devseg/methods/dcharts/tuning.h"

namespace devseg::dcharts {

namespace {

Index coarse_faces(const Mesh& mesh, const Draft& draft) {
    return std::max({tuning.trial_faces, tuning.trial_faces_per_chart * draft.charts_number(),
                     static_cast<Index>(tuning.trial_share * mesh.face_count())});
}

// Borders and cuts, 3 #F.
std::vector<std::uint8_t> lines_of(const Mesh& mesh, const Draft& draft) {
    std::vector<std::uint8_t> lines = draft.seam;
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0 && draft.chart[face_of(h)] != draft.chart[mesh.across(h)])
            lines[h] = 1;
    return lines;
}

} // namespace

bool CoarseTrials::pay(const Mesh& mesh, const Draft& draft) {
    return mesh.face_count() > tuning.worth_decimation * coarse_faces(mesh, draft);
}

CoarseTrials::CoarseTrials(const Mesh& mesh, const Draft& draft,
                           const std::vector<std::uint8_t>& fixed, double wanted_l2,
                           Progress& progress)
    : coarse_(mesh::coarsen_between_lines(mesh, coarse_faces(mesh, draft), lines_of(mesh, draft),
                                          fixed, progress)),
      has_(mesh.points.size(), 0), edge_(mesh.twin.size(), -1) {
    for (const Index v : coarse_.vertex)
        has_[at(v)] = 1;
    std::vector<Index> chart;
    for (const Index f : coarse_.face)
        chart.push_back(draft.chart[at(f)]);
    const std::vector<Index>& line = coarse_.surface.line;
    std::vector<std::uint8_t> seam(coarse_.mesh.twin.size(), 0);
    std::vector<Index> by_line(mesh.twin.size(), -1);
    for (const HalfEdge h : coarse_.mesh.all_half_edges()) {
        const Index number = line[at(half_edge_of(coarse_.face[face_of(h)], corner_of(h)))];
        if (number < 0)
            continue;
        by_line[at(number)] = std::min<Index>(h, coarse_.mesh.twin[h]);
        seam[h] = draft.seam[at(number)];
    }
    const std::vector<std::uint8_t> lines = lines_of(mesh, draft);
    for (const HalfEdge h : mesh.all_half_edges())
        if (lines[h] != 0 && mesh.twin[h] >= 0)
            edge_[h] = by_line[at(line[h])];
    draft_ = make_draft(coarse_.mesh, chart, seam, wanted_l2, progress);
    draft_.faces.resize(draft.faces.size());
    draft_.map.resize(draft.faces.size());
}

judge::TrialMap CoarseTrials::try_closing(const Closing& closing,
                                          const std::vector<std::uint8_t>& seam,
                                          const judge::TrialEffort& effort, std::vector<Vec2> turns,
                                          const Progress& progress) const {
    Closing coarse{closing.charts, {}, {}};
    for (const Index h : closing.edges)
        coarse.edges.push_back(edge_[at(h)]);
    std::sort(coarse.edges.begin(), coarse.edges.end());
    coarse.edges.erase(std::unique(coarse.edges.begin(), coarse.edges.end()), coarse.edges.end());
    const std::vector<Index> faces = united_faces(draft_, closing.charts);
    std::vector<std::uint8_t> marks(coarse_.mesh.twin.size(), 0);
    for (const Face f : faces)
        for (const HalfEdge h : half_edges_of(f)) {
            const Index number =
                coarse_.surface.line[at(half_edge_of(coarse_.face[f], corner_of(h)))];
            marks[h] = number < 0 ? 0 : seam[at(number)];
        }
    if (turns.empty())
        turns = joined_turns(coarse_.mesh, draft_, coarse);
    return judge::try_chart(coarse_.mesh, faces, marks, effort, progress, turns);
}

void CoarseTrials::close(const Pair& charts, judge::TrialMap map) {
    const auto [a, b] = charts;
    draft_.map[a] = std::move(map);
    if (a == b)
        return;
    draft_.faces[a] = united_faces(draft_, charts);
    for (const Face f : draft_.faces[b])
        draft_.chart[f] = a;
    draft_.faces[b].clear();
}

std::vector<Index> united_faces(const Draft& draft, const Pair& charts) {
    const std::vector<Index>& a = draft.faces[charts.first];
    if (charts.first == charts.second)
        return a;
    const std::vector<Index>& b = draft.faces[charts.second];
    std::vector<Index> faces(a.size() + b.size());
    std::merge(a.begin(), a.end(), b.begin(), b.end(), faces.begin());
    return faces;
}

} // namespace devseg::dcharts
