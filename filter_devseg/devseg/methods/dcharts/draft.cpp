#include "devseg/methods/dcharts/draft.h"

#include <algorithm>

#include "devseg/base/parallel.h"

namespace devseg::dcharts {

Index Draft::charts_number() const {
    return static_cast<Index>(
        std::count_if(faces.begin(), faces.end(), [](const auto& part) { return !part.empty(); }));
}

double Draft::excess() const {
    double sum = 0.0;
    for (std::size_t c = 0; c < faces.size(); ++c)
        sum += faces[c].empty() ? 0.0 : map[c].excess();
    return sum;
}

double Draft::linf() const {
    double worst = 1.0;
    for (std::size_t c = 0; c < faces.size(); ++c)
        worst = faces[c].empty() ? worst : std::max(worst, map[c].linf);
    return worst;
}

Draft make_untried_draft(const Mesh& mesh, const std::vector<Index>& chart) {
    Draft draft;
    draft.chart = chart;
    draft.seam.assign(mesh.twin.size(), 0);
    for (const Face f : mesh.all_faces()) {
        const std::size_t c = at(chart[f]);
        if (draft.faces.size() <= c)
            draft.faces.resize(c + 1);
        draft.faces[c].push_back(f);
    }
    draft.map.resize(draft.faces.size());
    return draft;
}

Draft make_draft(const Mesh& mesh, const std::vector<Index>& chart,
                 const std::vector<std::uint8_t>& seam, double wanted_l2, Progress& progress) {
    Draft draft = make_untried_draft(mesh, chart);
    if (!seam.empty())
        draft.seam = seam;
    judge::TrialEffort effort;
    effort.wanted_l2 = wanted_l2;
    parallel_for(
        static_cast<int>(draft.faces.size()),
        [&](int i) {
            const std::size_t c = static_cast<std::size_t>(i);
            if (!draft.faces[c].empty())
                draft.map[c] = judge::try_chart(mesh, draft.faces[c], draft.seam, effort, progress);
        },
        progress);
    return draft;
}

} // namespace devseg::dcharts
