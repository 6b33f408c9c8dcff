#include <algorithm>
#include <numeric>
#include <optional>

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
    "Makes every seam between charts, every dart and every slit a smooth curve on the surface, "
    "free of the mesh's edges, and splits the faces along it. The surface stays the same: new "
    "vertices lie on old faces, and all attributes of faces and vertices are carried over.<br>"
    "Junctions slide with their seams. Seams on creases and the ends of seams on the mesh's border "
    "stay where they are, and so does a seam that cannot be moved soundly; "
    "<b>kept_seams_number</b> counts them. Charts are read from the face attribute "
    "<b>chart_id</b>; without it from the wedge texture coordinates. Flatten the charts "
    "afterwards.<br>"
    "See:<br><i>Stephan Bischoff, Tobias Weyand, Leif Kobbelt</i><br>"
    "<b>\"Snakes on Triangle Meshes\"</b><br>"
    "Bildverarbeitung f&uuml;r die Medizin, 2005, doi:10.1007/3-540-26431-0_43";

struct Tuning {
    // Of smoothing, where charts come out above a bound: seams are made firmer around the places
    // where they are, then all seams of those charts, and in the end of all that ever were above.
    int local_rounds = 6;
    int most_rounds = 16;
    double reach = 1.0;    // smoothness: what is made firmer around a place; twice each time
    double exact = 1.0001; // L2 stretch that nobody can measure: charts within it stay within it
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

// What is wrong with a chart: the middles of its faces where it is.
struct Excess {
    bool is_above = false;
    bool is_torn = false;     // it has no map in one piece, and is cut when it is flattened
    std::vector<Vec3> places; // none: everywhere
};

Excess strain_above(const Mesh& mesh, const std::vector<Index>& faces,
                    const std::vector<std::uint8_t>& seam, double bound, const Progress& progress) {
    judge::ClothLimits limits;
    limits.max_strain = bound;
    limits.is_search = false;
    const judge::ClothTrial trial = judge::try_cloth(mesh, faces, seam, limits, true, progress);
    Excess excess{!trial.has_map || trial.strain.most_of_it > bound, !trial.has_map, {}};
    for (std::size_t k = 0; k < trial.strains.size() && excess.is_above; ++k)
        if (trial.strains[k] > bound)
            excess.places.push_back(mesh.face_centers[trial.face[k]]);
    return excess;
}

// Of which of the charts it is sure that they are within their bounds. Each is looked at on its
// own: what is as large as the mesh costs too much for each of thousands.
std::vector<std::uint8_t> surely_within(const Mesh& mesh, const atlas::ChartMap& charts,
                                        const std::vector<std::uint8_t>& chosen,
                                        const std::vector<double>& bounds, Progress& progress) {
    const std::vector<atlas::ChartSurface> surfaces = atlas::extract_charts(mesh, charts);
    std::vector<std::uint8_t> within(surfaces.size(), 0);
    parallel_for(
        static_cast<int>(charts.count),
        [&](int c) {
            if (chosen[at(c)] == 0)
                return;
            const Mesh part = atlas::mesh_of(mesh, surfaces[at(c)]);
            std::vector<Index> faces(part.faces.size());
            std::iota(faces.begin(), faces.end(), 0);
            const std::vector<std::uint8_t> no_cuts(part.twin.size(), 0);
            within[at(c)] =
                judge::is_surely_within(part, faces, no_cuts, bounds[at(c)], progress) ? 1 : 0;
        },
        progress);
    return within;
}

// Of the charts as they were: the given bound, and none that loses what unfolded exactly, as boxes
// do.
std::vector<double> stretch_bounds(const Mesh& mesh, const atlas::ChartMap& charts, double bound,
                                   Progress& progress) {
    std::vector<double> bounds(at(charts.count), bound);
    if (!(bound > tuning.exact))
        return bounds;
    const std::vector<std::uint8_t> exact =
        surely_within(mesh, charts, std::vector<std::uint8_t>(bounds.size(), 1),
                      std::vector<double>(bounds.size(), tuning.exact), progress);
    for (std::size_t c = 0; c < bounds.size(); ++c)
        if (exact[c] != 0)
            bounds[c] = tuning.exact;
    return bounds;
}

// Which of the chosen charts have a final map above their bound: trials leave out what relieves
// peaks.
void judge_stretch(const Mesh& mesh, const atlas::ChartMap& charts, const Buckets<Index>& faces,
                   const std::vector<std::uint8_t>& chosen, const std::vector<double>& bounds,
                   std::vector<Excess>& above, Progress& progress) {
    const std::vector<std::uint8_t> within = surely_within(mesh, charts, chosen, bounds, progress);
    std::vector<std::vector<Index>> tried;
    std::vector<std::size_t> number;
    for (std::size_t c = 0; c < chosen.size(); ++c)
        if (chosen[c] != 0 && within[c] == 0) {
            tried.emplace_back(faces[static_cast<Index>(c)].begin(),
                               faces[static_cast<Index>(c)].end());
            number.push_back(c);
        }
    // To the end: pushing overlaps apart takes some maps below their bound.
    const std::vector<judge::TrialMap> maps =
        judge::whole_maps(mesh, tried, charts.seam, {}, progress);
    // Flattening itself tells whether one that does not look whole is cut apart.
    std::vector<std::vector<Index>> doubtful;
    for (std::size_t i = 0; i < maps.size(); ++i)
        if (!maps[i].flat)
            doubtful.push_back(tried[i]);
    const std::vector<judge::TrialMap> known =
        judge::final_maps(mesh, doubtful, charts.seam, progress);
    auto next = known.begin();
    for (std::size_t i = 0; i < maps.size(); ++i) {
        const judge::TrialMap& map = maps[i].flat ? maps[i] : *next++;
        const double bound = bounds[number[i]];
        if (!map.flat || map.l2_squared > bound * bound)
            above[number[i]] = {true, !map.flat, {}}; // stretch is not to be had at one place
    }
}

// Which of the chosen charts are above a bound, and where.
std::vector<Excess> above(const Mesh& mesh, const atlas::ChartMap& charts,
                          const std::vector<std::uint8_t>& chosen, const Options& options,
                          const std::vector<double>& stretch, Progress& progress) {
    const Buckets<Index> faces = atlas::group_faces(charts);
    std::vector<Excess> result(chosen.size());
    if (options.max_strain > 0.0)
        parallel_for(
            static_cast<int>(charts.count),
            [&](int c) {
                const std::vector<Index> own(faces[c].begin(), faces[c].end());
                if (chosen[at(c)] != 0)
                    result[at(c)] =
                        strain_above(mesh, own, charts.seam, options.max_strain, progress);
            },
            progress);
    if (options.max_chart_l2_stretch > 0.0)
        judge_stretch(mesh, charts, faces, chosen, stretch, result, progress);
    return result;
}

Vec3 middle_of(const Mesh& mesh, HalfEdge h) {
    return 0.5 * (mesh.points[mesh.origin(h)] + mesh.points[mesh.target(h)]);
}

// Marks the seam edges of a chart around the places where it is above: up to `reach` farther away
// than the nearest of them. All of them where it is above everywhere.
void mark_around(const Mesh& mesh, const std::vector<HalfEdge>& seam, const Excess& excess,
                 double reach, std::vector<std::uint8_t>& marked) {
    const bool everywhere = excess.places.empty() || reach == infinite;
    const std::vector<Vec3> none{Vec3::Zero()};
    for (const Vec3& place : everywhere ? none : excess.places) {
        double nearest = infinite;
        for (const HalfEdge h : seam)
            nearest = std::min(nearest, (place - middle_of(mesh, h)).norm());
        for (const HalfEdge h : seam)
            if (everywhere || (place - middle_of(mesh, h)).norm() <= nearest + reach)
                marked[h] = marked[mesh.twin[h]] = 1;
    }
}

// The seams of a chart that is above come nearer to where they were, and then all the way, around
// the places where it is above first.
bool make_firmer(const Mesh& mesh, const atlas::ChartMap& charts, const std::vector<Excess>& excess,
                 double reach, std::vector<curves::Firmness>& firmness) {
    using curves::Firmness;
    std::vector<std::vector<HalfEdge>> seam(excess.size());
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0 && charts.seam[h] != 0)
            seam[at(charts.chart[face_of(h)])].push_back(h);
    std::vector<std::uint8_t> marked(firmness.size(), 0);
    for (std::size_t c = 0; c < excess.size(); ++c)
        if (excess[c].is_above)
            mark_around(mesh, seam[c], excess[c], reach, marked);
    bool changed = false;
    for (const HalfEdge h : mesh.all_half_edges()) {
        if (marked[h] == 0 || firmness[h] == Firmness::held)
            continue;
        firmness[h] = reach == infinite
                          ? Firmness::held
                          : static_cast<Firmness>(static_cast<std::uint8_t>(firmness[h]) + 1);
        changed = true;
    }
    return changed;
}

// Smooth seams; those of charts that are above a bound then, and were not before, stay.
curves::SmoothSeams smooth_within(const FilterInput& input, const atlas::ChartMap& charts,
                                  const Options& options, int& kept_charts, Progress& progress) {
    const Mesh& mesh = input.mesh;
    const double bound = options.max_chart_l2_stretch;
    if (bound > 0.0 && bound <= 1.0)
        refuse_option("max_chart_l2_stretch", "0 for no bound, or a number above 1", bound);
    if (!options.has_bounds())
        return curves::smooth_seams(mesh, charts, options, progress);
    auto finding = progress.part(0.1);
    const auto plane = curves::seam_plane(mesh, options, finding);
    auto looking = progress.part("judging charts", 0.1);
    const std::vector<double> stretch = stretch_bounds(mesh, charts, bound, looking);
    std::vector<curves::Firmness> firmness(mesh.twin.size(), curves::Firmness::free);
    std::vector<std::uint8_t> judged(at(charts.count), 1); // but for those above already before
    std::vector<Excess> kept(judged.size());
    double reach = tuning.reach * curves::smoothing_scale(mesh, charts, options);
    for (int round = 1;; ++round) {
        auto smoothing = progress.part(0.5 * progress.left());
        curves::SmoothSeams made =
            curves::smooth_seams(mesh, charts, options, plane, smoothing, firmness);
        auto judging = progress.part("judging charts", 0.5 * progress.left());
        std::vector<Excess> after = above(input.as_stored(made.refinement.mesh), made.charts, judged,
                                          options, stretch, judging);
        std::vector<std::uint8_t> doubtful(after.size(), 0);
        for (std::size_t c = 0; c < after.size(); ++c)
            doubtful[c] = after[c].is_above ? 1 : 0;
        const std::vector<Excess> before = above(mesh, charts, doubtful, options, stretch, judging);
        for (std::size_t c = 0; c < after.size(); ++c) {
            // One that is cut may get parts within the bound, or far above it.
            if (before[c].is_above && before[c].is_torn == after[c].is_torn) {
                judged[c] = 0;
                after[c] = {};
            }
            kept[c].is_above = kept[c].is_above || after[c].is_above;
        }
        kept_charts = static_cast<int>(
            std::count_if(kept.begin(), kept.end(), [](const Excess& e) { return e.is_above; }));
        const bool is_last = round + 1 >= tuning.most_rounds;
        const bool is_local = round < tuning.local_rounds;
        if (!make_firmer(mesh, charts, is_last ? kept : after, is_local ? reach : infinite,
                         firmness))
            return made;
        reach *= 2.0;
    }
}

// Colours of the faces of the finer mesh, where every chart had one colour: parts of split faces go
// to other charts, whose colour they take. Nothing where faces have colours of their own.
std::optional<std::vector<Color>> colors_of_charts(const std::vector<Color>& color,
                                                   const atlas::ChartMap& charts,
                                                   const atlas::ChartMap& finer) {
    if (color.empty())
        return std::nullopt;
    std::vector<Color> of_chart(at(charts.count));
    const Buckets<Index> faces = atlas::group_faces(charts);
    for (Index c = 0; c < charts.count; ++c) {
        of_chart[at(c)] = color[at(*faces[c].begin())];
        for (const Index f : faces[c])
            if (color[at(f)] != of_chart[at(c)])
                return std::nullopt;
    }
    std::vector<Color> result;
    for (const Index c : finer.chart)
        result.push_back(of_chart[at(c)]);
    return result;
}

FilterOutput run_smooth(const FilterInput& input, const Options& options, Progress& progress) {
    const atlas::ChartMap charts = find_charts(input);
    int kept_charts = 0;
    curves::SmoothSeams made = smooth_within(input, charts, options, kept_charts, progress);
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
    output.face_color = colors_of_charts(input.color, charts, made.charts);
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
            .real(
                &O::smoothness, "Smoothness",
                "Length of the waves that go, as a share of the diagonal of the model's box: 0.01 "
                "= 1 %. It is at least that of the edges on seams.")
            .real(&O::keep_creases, "Keep creases (degrees)",
                  "Seams on edges where the surface bends by more, in degrees, stay where they "
                  "are. 180 = none.")
            .boolean(
                &O::symmetric, "symmetric", "Symmetric",
                "Where the model is nearly its own mirror image, seams that nearly mirror each "
                "other do so exactly, whatever its faces are.")
            .real(&O::max_chart_l2_stretch, "Largest L2 stretch of a chart",
                  "Seams of a chart stay on their edges where smooth ones bring its root mean "
                  "square stretch, which has no unit, above this bound. 0 = none, which saves the "
                  "trial flattenings.")
            .real(&O::max_strain, "Largest strain of a chart",
                  "The same for cloth: seams of a chart stay where smooth ones strain 99 % of its "
                  "area by more than this share in any direction. 0 = none.")
            .on_part()
            .writes(writes_charts | writes_color | writes_mesh)
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
