// The only source that includes CGAL: its mean curvature skeletons. Reading of skeletons.
#include "devseg/methods/plush/skeleton.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <fstream>
#include <map>
#include <memory>
#include <new>
#include <sstream>
#include <utility>

#include "devseg/base/errors.h"
#include "devseg/mesh/coarsen.h"
#include "devseg/methods/plush/seam_network.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

// CGAL keeps elements of its meshes in sets ordered by their addresses. They come from one block
// and are never given back before its end, so that their order is that of their making, and the
// skeleton the same every time.
class SkeletonArena {
public:
    SkeletonArena() : block_(new std::byte[tuning.skeleton_memory]) { current() = this; }
    ~SkeletonArena() { current() = nullptr; }
    SkeletonArena(const SkeletonArena&) = delete;
    SkeletonArena& operator=(const SkeletonArena&) = delete;

    static SkeletonArena*& current() {
        thread_local SkeletonArena* arena = nullptr;
        return arena;
    }
    void* take(std::size_t bytes) {
        bytes = (bytes + alignof(std::max_align_t) - 1) / alignof(std::max_align_t) *
                alignof(std::max_align_t);
        if (tuning.skeleton_memory - used_ < bytes)
            throw std::bad_alloc();
        used_ += bytes;
        return block_.get() + used_ - bytes;
    }

private:
    std::unique_ptr<std::byte[]> block_;
    std::size_t used_ = 0;
};

template <class T>
struct SkeletonAllocator {
    using value_type = T;
    SkeletonAllocator() = default;
    template <class U>
    SkeletonAllocator(const SkeletonAllocator<U>&) {} // NOLINT: allocators convert
    T* allocate(std::size_t n) {
        return static_cast<T*>(SkeletonArena::current()->take(n * sizeof(T)));
    }
    void deallocate(T*, std::size_t) {}
    template <class U>
    bool operator==(const SkeletonAllocator<U>&) const {
        return true;
    }
    template <class U>
    bool operator!=(const SkeletonAllocator<U>&) const {
        return false;
    }
};

} // namespace devseg::plush

// CGAL checks itself in every build, and failed checks become exceptions: a host must never be
// aborted.
#define CGAL_DEBUG
#define CGAL_DISABLE_GMP 1 // nothing here needs exact numbers: no library to link
#define CGAL_EIGEN3_ENABLED
#define CGAL_ALLOCATOR(T) devseg::plush::SkeletonAllocator<T>
#include <CGAL/Mean_curvature_flow_skeletonization.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/assertions_behaviour.h>

namespace devseg::plush {

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Flow = CGAL::Mean_curvature_flow_skeletonization<Surface>;

// CGAL reports failed checks by exceptions while this lives.
class ThrowingChecks {
public:
    ThrowingChecks() : before_(CGAL::set_error_behaviour(CGAL::THROW_EXCEPTION)) {}
    ~ThrowingChecks() { CGAL::set_error_behaviour(before_); }
    ThrowingChecks(const ThrowingChecks&) = delete;
    ThrowingChecks& operator=(const ThrowingChecks&) = delete;

private:
    CGAL::Failure_behaviour before_;
};

struct Curves {
    std::vector<Vec3> points;
    std::vector<std::vector<Index>> links; // of each point
};

Surface to_surface(const Mesh& mesh, const std::vector<Index>& label, Index component) {
    Surface surface;
    std::vector<Surface::Vertex_index> vertex(mesh.points.size());
    for (const Face f : mesh.all_faces()) {
        if (label[f] != component)
            continue;
        std::array<Surface::Vertex_index, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t v = at(mesh.faces[f][k]);
            const Vec3& p = mesh.points[v];
            if (!vertex[v].is_valid())
                vertex[v] = surface.add_vertex({p.x(), p.y(), p.z()});
            corners[k] = vertex[v];
        }
        surface.add_face(corners[0], corners[1], corners[2]);
    }
    return surface;
}

Curves contract(const Surface& surface, const Progress& progress) {
    Flow flow(surface);
    // The same steps as CGAL's contract_until_convergence, with a look at the user in between.
    const double enough =
        flow.area_variation_factor() * CGAL::Polygon_mesh_processing::area(surface);
    double area = 0.0;
    for (std::size_t i = 0; i < flow.max_iterations(); ++i) {
        progress.check();
        flow.contract();
        const double before =
            std::exchange(area, CGAL::Polygon_mesh_processing::area(flow.meso_skeleton()));
        if (i > 0 && std::abs(area - before) < enough)
            break;
    }
    Flow::Skeleton skeleton;
    flow.convert_to_skeleton(skeleton);
    Curves curves;
    std::map<Flow::Skeleton::vertex_descriptor, Index> number;
    for (const auto v : CGAL::make_range(vertices(skeleton))) {
        number[v] = static_cast<Index>(curves.points.size());
        const auto& p = skeleton[v].point;
        curves.points.emplace_back(p.x(), p.y(), p.z());
    }
    curves.links.resize(curves.points.size());
    for (const auto e : CGAL::make_range(edges(skeleton))) {
        curves.links[number[source(e, skeleton)]].push_back(number[target(e, skeleton)]);
        curves.links[number[target(e, skeleton)]].push_back(number[source(e, skeleton)]);
    }
    return curves;
}

// Douglas and Peucker's polyline: keeps the ends and what lies farther off than `allowed`.
void simplify(const std::vector<Vec3>& line, std::size_t first, std::size_t last, double allowed,
              std::vector<std::size_t>& kept) {
    double farthest = allowed;
    std::size_t split = 0;
    for (std::size_t i = first + 1; i < last; ++i) {
        const double d = std::sqrt(squared_distance(line[i], line[first], line[last]));
        if (d > farthest) {
            farthest = d;
            split = i;
        }
    }
    if (split > 0) {
        simplify(line, first, split, allowed, kept);
        simplify(line, split, last, allowed, kept);
    } else {
        kept.push_back(last);
    }
}

// Follows each curve from one end or branch to the next, and adds its bones.
void add_bones(const Curves& curves, double size, Skeleton& skeleton) {
    const auto is_node = [&](Vertex v) { return curves.links[v].size() != 2; };
    for (Index start = 0; start < static_cast<Index>(curves.points.size()); ++start) {
        if (!is_node(start))
            continue;
        for (const Index first : curves.links[start]) {
            std::vector<Index> walk{start, first};
            while (!is_node(walk.back()) && walk.size() <= curves.points.size()) {
                const auto& next = curves.links[walk.back()];
                walk.push_back(next[0] == walk[walk.size() - 2] ? next[1] : next[0]);
            }
            if (walk.back() < start || (walk.back() == start && walk[1] > walk[walk.size() - 2]))
                continue; // the other direction is taken
            std::vector<Vec3> line;
            for (const Vertex v : walk)
                line.push_back(curves.points[v]);
            std::vector<std::size_t> kept{0};
            simplify(line, 0, line.size() - 1, tuning.bone_tolerance * size, kept);
            for (std::size_t i = 1; i < kept.size(); ++i) {
                if ((line[kept[i]] - line[kept[i - 1]]).norm() < tuning.shortest_bone * size)
                    continue;
                const auto joint = static_cast<Index>(skeleton.joints.size());
                skeleton.joints.push_back(line[kept[i - 1]]);
                skeleton.joints.push_back(line[kept[i]]);
                skeleton.bones.push_back({joint, joint + 1});
            }
        }
    }
}

[[noreturn]] void refuse_line(const std::string& path, int line, const std::string& found) {
    throw InvalidParameter("skeleton_file: expected lines 'v X Y Z' and 'l I J' with joints "
                           "counted from 1, found '" +
                           found + "' in line " + std::to_string(line) + " of " + path);
}

void read_bones(std::istringstream& words, Skeleton& skeleton, bool& is_valid) {
    Index previous = -1;
    for (long joint = 0; words >> joint; previous = static_cast<Index>(joint - 1)) {
        is_valid = is_valid && joint >= 1 && joint <= static_cast<long>(skeleton.joints.size());
        if (!is_valid)
            return;
        if (previous >= 0 && previous != joint - 1)
            skeleton.bones.push_back({previous, static_cast<Index>(joint - 1)});
    }
    is_valid = is_valid && previous >= 0 && words.eof();
}

} // namespace

Skeleton extract_skeleton(const Mesh& mesh, const Progress& progress) {
    Skeleton skeleton;
    const double size = mesh.diagonal();
    const mesh::CoarseMesh coarse = mesh::coarsen(mesh, tuning.skeleton_faces, progress);
    const mesh::FaceComponents parts =
        mesh::face_components(coarse.mesh, [](Index) { return true; });
    std::vector<Index> faces(at(parts.count), 0);
    std::vector<std::uint8_t> is_open(at(parts.count), 0);
    for (const HalfEdge h : coarse.mesh.all_half_edges()) {
        faces[parts.label[face_of(h)]] += corner_of(h) == 0 ? 1 : 0;
        if (coarse.mesh.twin[h] < 0)
            is_open[parts.label[face_of(h)]] = 1;
    }
    const ThrowingChecks guard;
    for (Index c = 0; c < parts.count; ++c) {
        if (is_open[c] != 0 || faces[c] < tuning.skeleton_faces / 100)
            continue;
        try {
            const SkeletonArena arena;
            add_bones(contract(to_surface(coarse.mesh, parts.label, c), progress), size, skeleton);
        } catch (const Cancelled&) {
            throw;
        } catch (const std::exception&) {
            // This part has no skeleton then: its seams are placed without one.
        }
    }
    return skeleton;
}

Skeleton read_skeleton(const std::string& path, const std::function<Vec3(const Vec3&)>& to_mesh) {
    std::ifstream file(path);
    if (!file)
        throw FileError("skeleton_file: expected a file of joints and bones, but " + path +
                        " cannot be read");
    Skeleton skeleton;
    std::string text;
    for (int line = 1; std::getline(file, text); ++line) {
        std::istringstream words(text);
        words.imbue(std::locale::classic());
        std::string key;
        if (!(words >> key) || key[0] == '#')
            continue;
        bool is_valid = true;
        if (key == "v") {
            Vec3 p;
            is_valid = static_cast<bool>(words >> p.x() >> p.y() >> p.z()) && p.allFinite();
            skeleton.joints.push_back(is_valid ? to_mesh(p) : p);
        } else if (key == "l") {
            read_bones(words, skeleton, is_valid);
        } else {
            is_valid = key == "o" || key == "g" || key == "s";
        }
        if (!is_valid)
            refuse_line(path, line, text);
    }
    if (skeleton.empty())
        throw InvalidParameter("skeleton_file: expected at least one bone (a line 'l I J'), found "
                               "none in " +
                               path);
    return skeleton;
}

} // namespace devseg::plush
