#include <algorithm>

#include "devseg/base/errors.h"
#include "devseg/base/parallel.h"
#include "devseg/curves/smooth_seams.h"
#include "devseg/declare/declare.h"
#include "devseg/judge/trial.h"

namespace devseg::filters {

using namespace declare;

namespace {

constexpr const char* smooth_help =
    "Makes every seam between charts, every dart and every slit a smooth curve on the surface, free "
    "of the mesh's edges, and splits the faces along it. The surface stays the same: new vertices "
    "lie on old faces, and all attributes of faces and vertices are carried over.<br>"
    "Junctions slide with their seams. Seams on creases and the ends of seams on the mesh's border "
    "stay where they are, and so does a seam that cannot be moved soundly; <b>kept_seams_number</b> "
    "counts them. Charts are read from the face attribute <b>chart_id</b>; without it from the "
    "wedge texture coordinates. Flatten the charts afterwards.<br>"
    "See:<br><i>Stephan Bischoff, Tobias Weyand, Leif Kobbelt</i><br>"
    "<b>\"Snakes on Triangle Meshes\"</b><br>"
    "Bildverarbeitung f&uuml;r die Medizin, 2005, doi:10.1007/3-540-26431-0_43";

struct Tuning {
    int rounds = 3; // of smoothing, where charts come out above the bound
};
constexpr Tuning tuning;

struct Options : curves::SmoothOptions {
    double max_chart_l2_stretch = 0.0; // none

    static OptionRanges<Options> ranges() {
        return {{&Options::smoothness, {"smoothness", 0.0, 0.2}},
                {&Options::keep_creases, {"keep_creases", 0.0, 180.0}},
                {&Options::max_chart_l2_stretch, {"max_chart_l2_stretch", 0.0, 100.0}}};
    }
};

// Which of the charts stretch by more than the bound.
std::vector<std::uint8_t> above(const Mesh& mesh, const atlas::ChartMap& charts, double bound,
                                Progress& progress) {
    const Buckets<Index> faces = atlas::group_faces(charts);
    std::vector<std::uint8_t> result(at(charts.count), 0);
    judge::TrialEffort effort;
    effort.wanted_l2 = bound;
    effort.push_apart = true;
    parallel_for(
        static_cast<int>(charts.count),
        [&](int c) {
            try {
                const judge::TrialMap map = judge::try_chart(
                    mesh, {faces[c].begin(), faces[c].end()}, charts.seam, effort, progress);
                result[at(c)] = !map.flat || map.l2_squared > bound * bound ? 1 : 0;
            } catch (const NumericalFailure&) { // no way to flatten it at all
                result[at(c)] = 1;
            }
        },
        progress);
    return result;
}

// Smooth seams; those of charts that are above the bound then, and were not before, stay.
curves::SmoothSeams smooth_within(const Mesh& mesh, const atlas::ChartMap& charts,
                                  const Options& options, int& kept_charts, Progress& progress) {
    const double bound = options.max_chart_l2_stretch;
    if (bound > 0.0 && bound <= 1.0)
        refuse_option("max_chart_l2_stretch", "0 for no bound, or a number above 1", bound);
    if (bound == 0.0)
        return curves::smooth_seams(mesh, charts, options, progress);
    std::vector<std::uint8_t> kept(at(charts.count), 0);
    auto judging = progress.part("judging charts", 0.2);
    const std::vector<std::uint8_t> before = above(mesh, charts, bound, judging);
    std::vector<std::uint8_t> held(mesh.twin.size(), 0);
    for (int round = 0;; ++round) {
        auto smoothing = progress.part(0.5 * progress.left());
        curves::SmoothSeams made = curves::smooth_seams(mesh, charts, options, smoothing, held);
        auto again = progress.part("judging charts", 0.5 * progress.left());
        const std::vector<std::uint8_t> after =
            above(made.refinement.mesh, made.charts, bound, again);
        bool more = false;
        for (std::size_t c = 0; c < kept.size(); ++c)
            if (after[c] != 0 && before[c] == 0 && kept[c] == 0) {
                kept[c] = 1;
                more = true;
            }
        kept_charts = static_cast<int>(std::count(kept.begin(), kept.end(), 1));
        if (!more)
            return made;
        for (const HalfEdge h : mesh.all_half_edges())
            if (mesh.twin[h] >= 0 && charts.seam[h] != 0 &&
                (round + 2 >= tuning.rounds || kept[charts.chart[face_of(h)]] != 0 ||
                 kept[charts.chart[mesh.across(h)]] != 0))
                held[h] = 1;
    }
}

FilterOutput run_smooth(const FilterInput& input, const Options& options, Progress& progress) {
    const atlas::ChartMap charts = find_charts(input);
    int kept_charts = 0;
    curves::SmoothSeams made = smooth_within(input.mesh, charts, options, kept_charts, progress);
    FilterOutput output;
    const double unit = input.mesh.unit_length;
    output.values = {
        {"charts_number", made.charts.count},
        {"kept_charts_number", kept_charts},
        {"smooth_seams_number", made.smooth_seams},
        {"kept_seams_number", made.kept_seams},
        {"new_faces_number", made.refinement.mesh.face_count() - input.mesh.face_count()},
        {"seam_length_before", made.old_length * unit},
        {"seam_length", made.new_length * unit},
    };
    output.charts = std::move(made.charts);
    output.refinement = std::move(made.refinement);
    return output;
}

} // namespace

std::vector<FilterDeclaration> smooth_filters() {
    using O = Options;
    return {
        Declare<O>("Charts: Smooth Seams", "meshing_smooth_chart_seams", FilterCategory::remeshing,
                   smooth_help)
            .real(&O::smoothness, "Smoothness",
                  "Length of the waves that go, as a share of the diagonal of the model's box: "
                  "0.01 = 1 %; at least that of the edges on seams.")
            .real(&O::keep_creases, "Keep creases (degrees)",
                  "Seams on edges where the surface bends by more, in degrees, stay where they "
                  "are. 180 = none.")
            .real(
                &O::max_chart_l2_stretch, "Largest L2 stretch of a chart",
                "Seams of a chart stay on their edges where smooth ones bring its root mean "
                "square stretch, which has no unit, above this bound. 0 = none, which saves the trial "
                "flattenings.")
            .on_part()
            .writes(writes_charts | writes_mesh)
            .result("charts_number", "charts, as many as before")
            .result("kept_charts_number", "charts whose seams stay because of the bound")
            .result("smooth_seams_number", "seams, darts and slits that are smooth curves now")
            .result("kept_seams_number", "those that stay on their edges")
            .result("new_faces_number", "faces that splitting added")
            .result("seam_length_before", "length of all cut edges before, model units")
            .result("seam_length", "the same afterwards")
            .runs(run_smooth)};
}

} // namespace devseg::filters
