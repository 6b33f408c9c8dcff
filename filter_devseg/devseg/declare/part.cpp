#include "devseg/declare/part.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "devseg/base/errors.h"
#include "devseg/base/option_checks.h"
#include "devseg/declare/segmentation_output.h"
#include "devseg/metrics/segmentation.h"
#include "devseg/plane/plane.h"

namespace devseg::declare {

namespace {

constexpr const char* selected_only = "selected_only";
constexpr const char* keep = "keep";

enum class Keep { none, seams, charts };

struct Scope {
    bool selected_only = false;
    Keep keep = Keep::none;

    bool is_all() const { return !selected_only && keep == Keep::none; }
};

Scope scope_of(const FilterDeclaration& filter, const ParameterValues& values) {
    Scope scope;
    if (const auto given = values.find(selected_only); filter.on_part && given != values.end())
        scope.selected_only = std::get<bool>(given->second);
    if (const auto given = values.find(keep); filter.keeps && given != values.end()) {
        const int choice = std::get<int>(given->second);
        if (choice < 0 || choice > 2)
            refuse_option(keep, "a choice from 0 to 2", choice);
        scope.keep = static_cast<Keep>(choice);
    }
    return scope;
}

std::vector<Index> faces_of(const FilterInput& whole, const Scope& scope) {
    const auto has_none = [](const auto& flags) {
        return std::all_of(flags.begin(), flags.end(), [](auto flag) { return flag <= 0; });
    };
    if (scope.selected_only && has_none(whole.selected))
        throw InvalidMesh(
            "selected_only: expected selected faces, found none; select some of them, "
            "or switch it off");
    std::vector<Index> faces;
    for (const Face f : whole.mesh.all_faces())
        if ((!scope.selected_only || whole.selected[f] != 0) &&
            (scope.keep != Keep::charts || (!whole.chart_id.empty() && whole.chart_id[f] < 0)))
            faces.push_back(f);
    if (faces.empty())
        throw InvalidMesh(
            "keep: expected faces without a chart (chart_id -1) beside the charts that "
            "stay, found none; choose Seams, or select faces and selected_only");
    return faces;
}

// The number of charts is an aim: more of them than faces are as many as faces. Whoever gave the
// number is told.
void limit_charts_number(const FilterDeclaration& filter, Index faces, ParameterValues& values,
                         std::vector<std::string>& notes) {
    constexpr const char* name = "charts_number";
    for (const Parameter& p : filter.parameters) {
        if (p.name != name)
            continue;
        ParameterValue& value = values.try_emplace(name, p.default_value).first->second;
        const int asked = std::get<int>(value);
        if (asked <= faces)
            continue;
        if (value != p.default_value)
            notes.push_back(std::string(name) + ": " + std::to_string(asked) +
                            " charts were asked for, and the mesh has " + std::to_string(faces) +
                            (faces == 1 ? " face" : " faces") +
                            " to divide among them: " + std::to_string(faces) + " was used");
        value = faces;
    }
}

FilterOutput run_limited(const FilterDeclaration& filter, const FilterInput& input,
                         ParameterValues values, Progress& progress) {
    std::vector<std::string> notes;
    limit_charts_number(filter, input.mesh.face_count(), values, notes);
    FilterOutput output = filter.run(input, values, progress);
    output.notes.insert(output.notes.begin(), notes.begin(), notes.end());
    return output;
}

template <class Value, class Places>
std::vector<Value> at_places(const std::vector<Value>& all, const Places& places) {
    std::vector<Value> some;
    if (!all.empty())
        for (const Index i : places)
            some.push_back(all[at(i)]);
    return some;
}

// Some faces as a mesh of its own, and the way back.
class Part {
public:
    Part(const FilterInput& whole, const Scope& scope)
        : whole_(whole), whole_charts_(find_charts(whole)),
          kept_(scope.keep == Keep::seams ? whole_charts_.seam
                                          : std::vector<std::uint8_t>(whole.mesh.twin.size(), 0)),
          inside_(whole.mesh.faces.size(), 0) {
        std::vector<Index> faces = faces_of(whole, scope);
        for (const Face f : faces)
            inside_[f] = 1;
        is_whole_ = faces.size() == inside_.size();
        const std::vector<std::uint8_t> marks = atlas::enclose(whole.mesh, faces, kept_);
        surface_ = atlas::extract_surface(whole.mesh, std::move(faces), marks);
        mesh_ = atlas::mesh_of(whole.mesh, surface_);
        source_face_ = at_places(whole.source_face, surface_.face);
        source_vertex_ = at_places(whole.source_vertex, surface_.vertex);
    }

    /// The whole's number of a face.
    Index face(Index f) const { return surface_.face[at(f)]; }

    FilterInput input() const {
        FilterInput part{
            mesh_, {}, {}, source_face_, source_vertex_, {}, {}, whole_.center, {}, {}, {}, {}, {},
            {},    {}, {}};
        if (whole_.charts)
            part.charts = charts();
        if (whole_.uv) {
            part.uv.emplace(mesh_.twin.size());
            for (const HalfEdge h : mesh_.all_half_edges())
                (*part.uv)[h] = (*whole_.uv)[surface_.mesh_half_edge(h)];
        }
        part.selected = at_places(whole_.selected, surface_.face);
        part.color = at_places(whole_.color, surface_.face);
        part.chart_id = at_places(whole_.chart_id, surface_.face);
        part.material = at_places(whole_.material, surface_.face);
        part.selected_vertices = at_places(whole_.selected_vertices, surface_.vertex);
        if (!whole_.selected_edges.empty())
            part.selected_edges = inner(whole_.selected_edges);
        return part;
    }

    void put_back(FilterOutput& output) const {
        if (output.refinement)
            put_back_refined(output);
        else if (output.charts)
            output.charts = whole_charts(*output.charts);
        if (output.face_quality)
            output.face_quality = spread(*output.face_quality);
        if (!output.selected.empty())
            output.selected = spread(output.selected);
        if (output.uv)
            output.uv = beside_others(*output.uv);
        const Mesh& mesh = output.refinement ? output.refinement->mesh : whole_.mesh;
        if (output.face_color)
            output.face_color =
                output.charts ? fitting_colors(mesh, *output.charts) : spread(*output.face_color);
        for (auto& [name, value] : output.values)
            if (name == "seam_length" && output.charts && !output.charts_go_on)
                value = metrics::seam_length(mesh, *output.charts);
        mark_untouched(output);
    }

private:
    // Those that the part's faces are in.
    atlas::ChartMap charts() const {
        return atlas::make_chart_map(mesh_, at_places(whole_charts_.chart, surface_.face),
                                     inner(whole_charts_.seam), true);
    }

    // Marks of half-edges that have a face on both sides in the part.
    std::vector<std::uint8_t> inner(const std::vector<std::uint8_t>& marks) const {
        std::vector<std::uint8_t> result(mesh_.twin.size(), 0);
        for (const HalfEdge h : mesh_.all_half_edges())
            result[h] = mesh_.twin[h] >= 0 ? marks[surface_.mesh_half_edge(h)] : 0;
        return result;
    }

    void mark_untouched(FilterOutput& output) const {
        if (is_whole_)
            return;
        for (const std::uint8_t inside : inside_)
            output.untouched.push_back(inside != 0 ? 0 : 1);
    }

    // Of all faces of the whole, as the host has them.
    const std::vector<Index>& numbers() const {
        return whole_.chart_id.empty() ? whole_charts_.chart : whole_.chart_id;
    }

    // Numbers of the part's charts that nothing outside has; where they can, they keep theirs.
    std::vector<Index> new_numbers(const atlas::ChartMap& charts) const {
        std::vector<Index> number(at(charts.count), -1);
        if (is_whole_) {
            std::iota(number.begin(), number.end(), 0);
            return number;
        }
        std::set<Index> used;
        for (const Face f : whole_.mesh.all_faces())
            if (inside_[f] == 0)
                used.insert(numbers()[f]);
        for (std::size_t i = 0; i < surface_.face.size(); ++i) {
            const Index old = numbers()[at(surface_.face[i])];
            Index& own = number[at(charts.chart[i])];
            if (own < 0 && old >= 0 && used.insert(old).second)
                own = old;
        }
        Index next = 0;
        for (Index& own : number) {
            while (own < 0 && !used.insert(next).second)
                ++next;
            own = own < 0 ? next : own;
        }
        return number;
    }

    atlas::ChartMap whole_charts(const atlas::ChartMap& part) const {
        const Mesh& mesh = whole_.mesh;
        atlas::ChartMap charts = whole_charts_;
        charts.chart = numbers();
        const std::vector<Index> number = new_numbers(part);
        for (const Face f : mesh_.all_faces()) {
            charts.chart[surface_.face[f]] = number[at(part.chart[f])];
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge own = surface_.mesh_half_edge(h);
                const HalfEdge twin = mesh.twin[own];
                charts.seam[own] = twin >= 0 && (part.seam[h] != 0 || mesh_.twin[h] < 0) ? 1 : 0;
                if (twin >= 0 && inside_[face_of(twin)] == 0)
                    charts.seam[twin] = 1;
            }
        }
        charts.count = 1 + *std::max_element(charts.chart.begin(), charts.chart.end());
        return charts;
    }

    template <class Value>
    std::vector<Value> spread(const std::vector<Value>& part) const {
        std::vector<Value> all(inside_.size(), Value{});
        for (const Face f : mesh_.all_faces())
            all[at(surface_.face[f])] = part[at(f)];
        return all;
    }

    // Charts that stay have their colours already.
    std::vector<Color> fitting_colors(const Mesh& mesh, const atlas::ChartMap& charts) const {
        std::vector<Index> chart(charts.chart.size(), 0); // without gaps between the numbers
        std::map<Index, Index> place;
        for (const Index c : charts.chart)
            place.emplace(c, 0);
        Index count = 0;
        for (auto& entry : place)
            entry.second = count++;
        std::vector<std::optional<Color>> given(at(count));
        for (std::size_t f = 0; f < chart.size(); ++f) {
            chart[f] = place.at(charts.chart[f]);
            if (f < inside_.size() && inside_[f] == 0 && !whole_.color.empty())
                given[at(chart[f])] = whole_.color[f];
        }
        return face_chart_colors(mesh, {std::move(chart), charts.seam, count}, given);
    }

    // At the scale of the coordinates outside, to the right of them, so that nothing overlaps.
    CornerUv beside_others(const CornerUv& part) const {
        constexpr double gap = 0.02; // of the size of the others
        const Mesh& mesh = whole_.mesh;
        CornerUv all = whole_.uv ? *whole_.uv : CornerUv(mesh.twin.size(), Vec2::Zero());
        Eigen::AlignedBox2d box;
        std::array<double, 2> plane{}; // outside, inside
        std::array<double, 2> surface{};
        for (const Face f : mesh.all_faces())
            if (inside_[f] == 0) {
                plane[0] += std::abs(plane::uv_area(all, f));
                surface[0] += mesh.face_areas[f];
                for (const HalfEdge h : half_edges_of(f))
                    box.extend(all[h]);
            }
        Eigen::AlignedBox2d own;
        for (const Face f : mesh_.all_faces()) {
            plane[1] += std::abs(plane::uv_area(part, f));
            surface[1] += mesh_.face_areas[f];
            for (const HalfEdge h : half_edges_of(f))
                own.extend(part[h]);
        }
        double scale = 1.0;
        Vec2 shift = Vec2::Zero();
        if (plane[0] > 0.0 && surface[0] > 0.0 && plane[1] > 0.0) {
            scale = std::sqrt(plane[0] / surface[0] * surface[1] / plane[1]);
            shift = Vec2(box.max().x() + gap * box.sizes().maxCoeff(), box.min().y()) -
                    scale * own.min();
        }
        for (const HalfEdge h : mesh_.all_half_edges())
            all[surface_.mesh_half_edge(h)] = scale * part[h] + shift;
        return all;
    }

    // The splits of the part's faces, of the same faces of the whole; those that add faces in the
    // order in which they did.
    std::vector<mesh::SplitFace> splits(const mesh::Refinement& fine) const {
        std::map<Index, std::vector<const mesh::Refinement::Part*>> of_source;
        for (const mesh::Refinement::Part& part : fine.parts)
            of_source[part.source].push_back(&part);
        std::vector<std::pair<Index, mesh::SplitFace>> found;
        for (const auto& [source, parts] : of_source) {
            mesh::SplitFace split{surface_.face[at(source)], {}, {}, {}};
            const auto add = [&](Index vertex, const Vec3& weights) {
                const auto known = std::find(split.points.begin(), split.points.end(), vertex);
                const auto place = static_cast<Index>(known - split.points.begin());
                if (known == split.points.end()) {
                    split.points.push_back(vertex);
                    split.weights.push_back(weights);
                }
                return place;
            };
            for (Index k = 0; k < 3; ++k)
                add(whole_.mesh.faces[split.face][at(k)], Vec3::Unit(k));
            for (const mesh::Refinement::Part* part : parts) {
                Triangle corners;
                for (std::size_t k = 0; k < 3; ++k)
                    corners[k] =
                        add(whole_vertex(fine.mesh.faces[at(part->face)][k]), part->corners[k]);
                split.parts.push_back(corners);
            }
            found.emplace_back(parts.size() > 1 ? parts[1]->face : 0, std::move(split));
        }
        std::stable_sort(found.begin(), found.end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
        std::vector<mesh::SplitFace> result;
        for (auto& item : found)
            result.push_back(std::move(item.second));
        return result;
    }

    Index whole_vertex(Index v) const {
        return v < mesh_.vertex_count() ? surface_.vertex[at(v)]
                                        : v - mesh_.vertex_count() + whole_.mesh.vertex_count();
    }

    // The whole's numbers of the part's charts: new ones, or those that go on outside.
    std::vector<Index> numbers_of(const FilterOutput& output) const {
        if (!output.charts_go_on)
            return new_numbers(*output.charts);
        const atlas::ChartMap before = this->charts();
        std::vector<Index> number(at(before.count));
        for (const Face f : mesh_.all_faces())
            number[at(before.chart[f])] = numbers()[at(surface_.face[f])];
        return number;
    }

    void put_back_refined(FilterOutput& output) const {
        const mesh::Refinement& fine = *output.refinement;
        const Mesh& mesh = whole_.mesh;
        std::vector<mesh::Refinement::Point> points = fine.points;
        for (mesh::Refinement::Point& p : points)
            p.face = surface_.face[at(p.face)];
        mesh::Refinement whole = mesh::refine(mesh, std::move(points), splits(fine));
        std::map<Index, const mesh::Refinement::Part*> part_at;
        for (const mesh::Refinement::Part& part : fine.parts)
            part_at[part.face] = &part;
        const std::vector<Index> number = numbers_of(output);
        atlas::ChartMap charts = whole_charts_;
        charts.chart = numbers();
        charts.chart.resize(whole.mesh.faces.size());
        charts.seam.resize(whole.mesh.twin.size());
        for (const Face f : fine.mesh.all_faces()) {
            const auto split = part_at.find(f);
            const Index source = split == part_at.end() ? Index{f} : Index{split->second->source};
            const Face to = f < mesh_.face_count() ? surface_.face[at(f)]
                                                   : f - mesh_.face_count() + mesh.face_count();
            charts.chart[to] = number[at(output.charts->chart[f])];
            for (Index k = 0; k < 3; ++k) {
                const HalfEdge h = half_edge_of(f, k);
                const HalfEdge own = half_edge_of(to, k);
                charts.seam[own] = output.charts->seam[h];
                const HalfEdge beyond = whole.mesh.twin[own];
                if (fine.mesh.twin[h] >= 0 || beyond < 0)
                    continue;
                const Index edge = split == part_at.end() ? k : mesh::old_edge(*split->second, k);
                const HalfEdge old = surface_.mesh_half_edge(half_edge_of(source, edge));
                charts.seam[own] = output.charts_go_on ? whole_charts_.seam[old] : 1;
                charts.seam[beyond] = charts.seam[own];
            }
        }
        charts.count = 1 + *std::max_element(charts.chart.begin(), charts.chart.end());
        output.charts = std::move(charts);
        output.refinement = std::move(whole);
    }

    const FilterInput& whole_;
    atlas::ChartMap whole_charts_;
    std::vector<std::uint8_t> kept_;   // 3 #F of the whole
    std::vector<std::uint8_t> inside_; // #F of the whole
    bool is_whole_ = false;
    atlas::ChartSurface surface_;
    Mesh mesh_;
    std::vector<Index> source_face_;
    std::vector<Index> source_vertex_;
};

} // namespace

std::vector<Parameter> part_parameters(bool on_part, bool keeps) {
    std::vector<Parameter> parameters;
    if (on_part)
        parameters.push_back({selected_only,
                              "Only the selected faces",
                              "Work on the selected faces as if there were no others: charts, "
                              "coordinates and colours of all others stay to the last bit.",
                              ParameterKind::boolean,
                              false,
                              0.0,
                              1.0,
                              {}});
    if (keeps)
        parameters.push_back({keep,
                              "Keep",
                              "None: nothing need stay. Seams: existing seams stay, and more may "
                              "come. Charts: existing charts stay, and faces without one, whose "
                              "chart_id is -1, get some.",
                              ParameterKind::choice,
                              0,
                              0.0,
                              2.0,
                              {"None", "Seams", "Charts"}});
    return parameters;
}

FilterOutput run_on_part(const FilterDeclaration& filter, const FilterInput& input,
                         ParameterValues values, Progress& progress) {
    const Scope scope = scope_of(filter, values);
    if (scope.is_all())
        return run_limited(filter, input, std::move(values), progress);
    const Part part(input, scope);
    FilterOutput output;
    try {
        output = run_limited(filter, part.input(), std::move(values), progress);
    } catch (InvalidMesh& error) {
        for (Index& f : error.faces)
            f = part.face(f);
        throw;
    }
    part.put_back(output);
    return output;
}

} // namespace devseg::declare
