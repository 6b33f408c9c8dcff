#include "devseg/assembly/limbs.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "devseg/graph/shortest_paths.h"
#include "devseg/graph/unions.h"

namespace devseg::assembly {

namespace {

struct Tuning {
    int places = 12; // that distances are measured from: twice as many as most toys have limbs
    // Of the surface: smaller ones, as ears and fingers, are parts of limbs, and larger ones are
    // bodies.
    double least = 0.03;
    double most = 0.4;
    // R² / A, with how far the tip of a limb is from its root, R: on a ball all is as far, but for
    // noise of 0.01. A tube with a closed end that is half as long as wide has 0.1.
    double reach = 0.04;

    // P² / 4πA below which a region with a border P and an area A is a limb. A part of a ball has
    // 1 − its share of the ball, so that no part of a ball is one; a tube with a closed end that is
    // as long as it is wide has 0.2.
    double limb() const { return 1.0 - most; }
};
constexpr Tuning tuning;

// Of each face that hangs together with the first one, the mean distance from places that are as
// far from each other as they can be.
void add_remoteness(const Mesh& mesh, const std::vector<Index>& faces,
                    graph::ShortestPaths<>& paths, const Progress& progress,
                    std::vector<double>& remoteness) {
    std::vector<double> nearest(faces.size(), infinite);
    const auto measure = [&](Index from) {
        paths.clear();
        paths.add_source(from);
        paths.run(
            [&](Index f, double distance) {
                for (const HalfEdge h : half_edges_of(Face(f)))
                    if (const Face g = mesh.across(h); g >= 0)
                        paths.reach(
                            g, distance + (mesh.face_centers[g] - mesh.face_centers[at(f)]).norm());
            },
            progress);
        Index farthest = 0;
        for (std::size_t i = 0; i < faces.size(); ++i) {
            nearest[i] = std::min(nearest[i], paths.distance[at(faces[i])]);
            if (nearest[i] > nearest[at(farthest)])
                farthest = static_cast<Index>(i);
        }
        return farthest;
    };
    Index place = measure(faces.front());
    std::fill(nearest.begin(), nearest.end(), infinite);
    for (int k = 0; k < tuning.places; ++k) {
        place = measure(faces[at(place)]);
        for (const Index f : faces)
            remoteness[at(f)] += paths.distance[at(f)] / tuning.places;
    }
}

// Of each half-edge, how far it goes along the line of equal remoteness in its face, with what is
// more remote at its left. The sum over a border of faces is as long as that line: zigzags cancel.
std::vector<double> level_lengths(const Mesh& mesh, const std::vector<double>& remoteness) {
    std::vector<double> sum(mesh.points.size(), 0.0);
    std::vector<double> count(mesh.points.size(), 0.0);
    for (const HalfEdge h : mesh.all_half_edges()) {
        sum[mesh.origin(h)] += remoteness[face_of(h)];
        count[mesh.origin(h)] += 1.0;
    }
    const auto along = [&](HalfEdge h) -> Vec3 {
        return mesh.points[mesh.target(h)] - mesh.points[mesh.origin(h)];
    };
    std::vector<double> lengths(mesh.twin.size(), 0.0);
    for (const Face f : mesh.all_faces()) {
        Vec3 line = Vec3::Zero();
        for (const HalfEdge h : half_edges_of(f)) // beside the corner of that value
            line += sum[mesh.apex(h)] / count[mesh.apex(h)] * along(h);
        for (const HalfEdge h : half_edges_of(f))
            lengths[h] = line.stableNormalized().dot(along(h));
    }
    return lengths;
}

// Regions that grow from tips, and what they become where they meet.
class Branches {
public:
    Branches(const Mesh& mesh, const std::vector<double>& remoteness)
        : mesh_(mesh), remoteness_(remoteness), lengths_(level_lengths(mesh, remoteness)),
          regions_(mesh.faces.size()), together_(mesh.faces.size()), groups_(mesh.faces.size()),
          is_there_(mesh.faces.size(), 0), limb_of_group_(mesh.faces.size(), -1),
          root_of_group_(mesh.faces.size(), 0), rank_(mesh.faces.size(), 0) {}

    // Takes the next face inwards, of a part of the mesh with this area.
    void add(Face f, double whole) {
        std::array<Index, 3> met{-1, -1, -1};
        std::size_t count = 0;
        Region own{f, mesh_.face_areas[f], 0.0, remoteness_[f], infinite, false};
        for (const HalfEdge h : half_edges_of(f)) {
            const Face g = mesh_.across(h);
            if (g < 0)
                continue;
            if (is_there_[g] == 0) {
                own.border += lengths_[h];
                continue;
            }
            const Index region = together_.find(g);
            if (std::find(met.begin(), met.end(), region) == met.end())
                met[count++] = region;
        }
        const auto matters = [&](Index r) {
            return regions_[at(r)].is_body || regions_[at(r)].narrowest < tuning.limb();
        };
        const bool branch =
            std::count_if(met.begin(), met.begin() + static_cast<std::ptrdiff_t>(count), matters) >
            1;
        for (const HalfEdge h : half_edges_of(f))
            if (const Face g = mesh_.across(h); g >= 0 && is_there_[g] != 0)
                regions_[at(together_.find(g))].border -= lengths_[mesh_.twin[h]];
        is_there_[f] = 1;
        regions_[f] = own;
        Index all = f;
        for (std::size_t i = 0; i < count; ++i)
            all = join(all, met[i], branch && matters(met[i]));
        rank_[f] = ++faces_;
        Region& now = regions_[at(all)];
        const double openness = now.border * now.border / (4.0 * pi * now.area);
        const double reach = now.tip - remoteness_[f];
        if (now.area > tuning.least * whole && now.area < tuning.most * whole &&
            reach * reach > tuning.reach * now.area && openness < now.narrowest) {
            now.narrowest = openness;
            root_of_group_[at(groups_.find(now.group))] = faces_;
        }
    }

    Limbs limbs() {
        Limbs result{std::vector<Index>(mesh_.faces.size(), -1), count_};
        for (const Face f : mesh_.all_faces())
            if (const Index group = groups_.find(f); rank_[f] <= root_of_group_[at(group)])
                result.of_face[f] = limb_of_group_[at(group)];
        return result;
    }

private:
    struct Region {
        Index group = -1; // in groups_
        double area = 0.0;
        double border = 0.0;
        double tip = 0.0;            // its largest remoteness
        double narrowest = infinite; // P² / 4πA so far, where it was as large as a limb
        bool is_body = false;        // limbs have met in it
    };

    // Both become one region; returns the one that stands for it. `met` keeps its limb where limbs
    // meet.
    Index join(Index a, Index met, bool limbs_meet) {
        Region& region = regions_[at(a)];
        const Region& other = regions_[at(met)];
        region.area += other.area;
        region.tip = std::max(region.tip, other.tip);
        region.border += other.border;
        if (!limbs_meet && other.narrowest < region.narrowest) {
            region.narrowest = other.narrowest;
            root_of_group_[at(groups_.find(region.group))] =
                root_of_group_[at(groups_.find(other.group))];
        }
        if (limbs_meet && !other.is_body)
            limb_of_group_[at(groups_.find(other.group))] = count_++;
        else
            groups_.join(groups_.find(region.group), groups_.find(other.group));
        region.is_body = region.is_body || other.is_body || limbs_meet;
        together_.join(a, met);
        return a;
    }

    const Mesh& mesh_;
    const std::vector<double>& remoteness_;
    std::vector<double> lengths_; // of half-edges, along the border
    std::vector<Region> regions_; // of the faces that stand for them in together_
    graph::Unions together_;
    graph::Unions groups_; // of faces: limbs, and bodies
    std::vector<std::uint8_t> is_there_;
    std::vector<Index> limb_of_group_;
    std::vector<Index> root_of_group_; // rank of the face where it was narrowest
    std::vector<Index> rank_;          // of each face, from 1 on
    Index faces_ = 0;
    Index count_ = 0;
};

} // namespace

Limbs find_limbs(const Mesh& mesh, const Progress& progress) {
    const mesh::FaceComponents parts = mesh::face_components(mesh, [](HalfEdge) { return true; });
    std::vector<std::vector<Index>> faces(at(parts.count));
    std::vector<double> area(faces.size(), 0.0);
    for (const Face f : mesh.all_faces()) {
        faces[at(parts.label[f])].push_back(f);
        area[at(parts.label[f])] += mesh.face_areas[f];
    }
    std::vector<double> remoteness(mesh.faces.size(), 0.0);
    graph::ShortestPaths<> paths(mesh.faces.size());
    for (const std::vector<Index>& part : faces)
        add_remoteness(mesh, part, paths, progress, remoteness);
    Branches branches(mesh, remoteness);
    Heartbeat beat(progress);
    for (std::size_t c = 0; c < faces.size(); ++c) {
        std::stable_sort(faces[c].begin(), faces[c].end(),
                         [&](Index f, Index g) { return remoteness[at(f)] > remoteness[at(g)]; });
        for (const Index f : faces[c]) {
            beat();
            branches.add(Face(f), area[c]);
        }
    }
    return branches.limbs();
}

} // namespace devseg::assembly
