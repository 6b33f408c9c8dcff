#include <algorithm>

#include "devseg/base/errors.h"
#include "devseg/base/parallel.h"
#include "devseg/curves/smooth_seams.h"
#include "devseg/declare/declare.h"
#include "devseg/judge/cloth.h"
#include "devseg/judge/final_map.h"

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
    int rounds = 5; // of smoothing, where charts come out above a bound
};
constexpr Tuning tuning;

struct Options : curves::SmoothOptions {
    double max_chart_l2_stretch = 0.0; // none
    double max_strain = 0.0;           // none

    bool has_bounds() const { return max_chart_l2_stretch > 0.0 || max_strain > 0.0; }

    static OptionRanges<Options> ranges() {
        return {{&Options::smoothness, {"smoothness", 0.0, 0.2}},
                {&Options::keep_creases, {"keep_creases", 0.0, 180.0}},
                {&Options::max_chart_l2_stretch, {"max_chart_l2_stretch", 0.0, 100.0}},
                {&Options::max_strain, {"max_strain", 0.0, 10.0}}};
    }
};

bool is_above_strain(const Mesh& mesh, const std::vector<Index>& faces,
                     const std::vector<std::uint8_t>& seam, double bound,
                     const Progress& progress) {
    judge::ClothLimits limits;
    limits.max_strain = bound;
    limits.is_search = false;
    const judge::ClothTrial trial = judge::try_cloth(mesh, faces, seam, limits, false, progress);
    return !trial.has_map || trial.strain.most_of_it > bound;
}

// Which of the chosen charts have a final map above the bound: trials leave out what relieves
// peaks.
void judge_stretch(const Mesh& mesh, const atlas::ChartMap& charts, const Buckets<Index>& faces,
                   const std::vector<std::uint8_t>& chosen, double bound,
                   std::vector<std::uint8_t>& above, Progress& progress) {
    std::vector<std::uint8_t> doubtful(chosen.size(), 0);
    parallel_for(
        static_cast<int>(charts.count),
        [&](int c) {
            const std::vector<Index> own(faces[c].begin(), faces[c].end());
            if (chosen[at(c)] != 0)
                doubtful[at(c)] =
                    judge::is_surely_within(mesh, own, charts.seam, bound, progress) ? 0 : 1;
        },
        progress);
    std::vector<std::vector<Index>> tried;
    std::vector<std::size_t> number;
    for (std::size_t c = 0; c < doubtful.size(); ++c)
        if (doubtful[c] != 0) {
            tried.emplace_back(faces[static_cast<Index>(c)].begin(),
                               faces[static_cast<Index>(c)].end());
            number.push_back(c);
        }
    const std::vector<judge::TrialMap> maps =
        judge::whole_maps(mesh, tried, charts.seam, bound, progress);
    for (std::size_t i = 0; i < maps.size(); ++i)
        if (!maps[i].flat || maps[i].l2_squared > bound * bound)
            above[number[i]] = 1;
}

// Which of the chosen charts are above a bound.
std::vector<std::uint8_t> above(const Mesh& mesh, const atlas::ChartMap& charts,
                                const std::vector<std::uint8_t>& chosen, const Options& options,
                                Progress& progress) {
    const Buckets<Index> faces = atlas::group_faces(charts);
    std::vector<std::uint8_t> result(chosen.size(), 0);
    if (options.max_strain > 0.0)
        parallel_for(
            static_cast<int>(charts.count),
            [&](int c) {
                const std::vector<Index> own(faces[c].begin(), faces[c].end());
                if (chosen[at(c)] != 0 &&
                    is_above_strain(mesh, own, charts.seam, options.max_strain, progress))
                    result[at(c)] = 1;
            },
            progress);
    if (options.max_chart_l2_stretch > 0.0)
        judge_stretch(mesh, charts, faces, chosen, options.max_chart_l2_stretch, result, progress);
    return result;
}

// The seams of a chart that is above come nearer to where they were, and then all the way.
bool make_firmer(const Mesh& mesh, const atlas::ChartMap& charts,
                 const std::vector<std::uint8_t>& is_above, bool is_last,
                 std::vector<curves::Firmness>& firmness) {
    using curves::Firmness;
    bool changed = false;
    for (const HalfEdge h : mesh.all_half_edges()) {
        if (mesh.twin[h] < 0 || charts.seam[h] == 0 || firmness[h] == Firmness::held)
            continue;
        if (is_above[charts.chart[face_of(h)]] == 0 && is_above[charts.chart[mesh.across(h)]] == 0)
            continue;
        firmness[h] = is_last || firmness[h] == Firmness::close ? Firmness::held : Firmness::close;
        changed = true;
    }
    return changed;
}

// Smooth seams; those of charts that are above a bound then, and were not before, stay.
curves::SmoothSeams smooth_within(const Mesh& mesh, const atlas::ChartMap& charts,
                                  const Options& options, int& kept_charts, Progress& progress) {
    const double bound = options.max_chart_l2_stretch;
    if (bound > 0.0 && bound <= 1.0)
        refuse_option("max_chart_l2_stretch", "0 for no bound, or a number above 1", bound);
    if (!options.has_bounds())
        return curves::smooth_seams(mesh, charts, options, progress);
    std::vector<curves::Firmness> firmness(mesh.twin.size(), curves::Firmness::free);
    std::vector<std::uint8_t> judged(at(charts.count), 1); // but for those above already before
    std::vector<std::uint8_t> kept(judged.size(), 0);
    for (int round = 1;; ++round) {
        auto smoothing = progress.part(0.5 * progress.left());
        curves::SmoothSeams made = curves::smooth_seams(mesh, charts, options, smoothing, firmness);
        auto judging = progress.part("judging charts", 0.5 * progress.left());
        std::vector<std::uint8_t> after =
            above(made.refinement.mesh, made.charts, judged, options, judging);
        const std::vector<std::uint8_t> before = above(mesh, charts, after, options, judging);
        for (std::size_t c = 0; c < after.size(); ++c) {
            judged[c] = before[c] != 0 ? 0 : judged[c];
            after[c] = before[c] != 0 ? 0 : after[c];
            kept[c] = kept[c] != 0 || after[c] != 0 ? 1 : 0;
        }
        kept_charts = static_cast<int>(std::count(kept.begin(), kept.end(), 1));
        const bool is_last = round + 1 >= tuning.rounds;
        if (!make_firmer(mesh, charts, is_last ? kept : after, is_last, firmness))
            return made;
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
    if (options.symmetric && !made.has_plane)
        output.notes.emplace_back("the model is not its own mirror image: both sides got seams of "
                                  "their own");
    output.charts = std::move(made.charts);
    output.charts_go_on = true;
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
            .boolean(
                &O::symmetric, "symmetric", "Symmetric",
                "Where the model is nearly its own mirror image, seams that nearly mirror each "
                "other do so exactly, whatever its faces are.")
            .real(
                &O::max_chart_l2_stretch, "Largest L2 stretch of a chart",
                "Seams of a chart stay on their edges where smooth ones bring its root mean "
                "square stretch, which has no unit, above this bound. 0 = none, which saves the trial "
                "flattenings.")
            .real(&O::max_strain, "Largest strain of a chart",
                  "The same for cloth: seams of a chart stay where smooth ones strain 99 % of its "
                  "area by more than this share in any direction. 0 = none.")
            .on_part()
            .writes(writes_charts | writes_mesh)
            .result("charts_number", "charts, as many as before")
            .result("kept_charts_number",
                    "charts whose seams stay nearer to edges because of a bound")
            .result("smooth_seams_number", "seams, darts and slits that are smooth curves now")
            .result("kept_seams_number", "those that stay on their edges")
            .result("new_faces_number", "faces that splitting added")
            .result("seam_length_before", "length of all cut edges before, model units")
            .result("seam_length", "the same afterwards")
            .runs(run_smooth)};
}

} // namespace devseg::filters
