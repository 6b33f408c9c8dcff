#include "host/split_faces.h"

#include <array>
#include <cmath>
#include <typeindex>
#include <vector>

namespace devseg::host {

namespace {

using declare::HostRefinement;

// Live elements in their order, by their place in the host's arrays.
template <class Elements>
std::vector<std::size_t> live_places(const Elements& elements) {
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < elements.size(); ++i)
        if (!elements[i].IsD())
            places.push_back(i);
    return places;
}

// What is at the corners of a face, as shares of one.
struct Mean {
    std::array<std::size_t, 3> corners{};
    Vec3 weights = Vec3::Zero();

    std::size_t nearest() const {
        Index k = 0;
        weights.maxCoeff(&k);
        return corners[static_cast<std::size_t>(k)];
    }
    template <class Number = Scalarm, class Value, class Of>
    Value of(Value zero, Of value) const {
        for (Index k = 0; k < 3; ++k)
            if (weights[k] > 0.0) // corners without weight may hold what is no number
                zero = static_cast<Value>(zero + value(corners[static_cast<std::size_t>(k)]) *
                                                     static_cast<Number>(weights[k]));
        return zero;
    }
};

template <class Value, class Number>
bool mean_attribute(const CMeshO::PointerToAttribute& attribute, std::size_t to, const Mean& mean,
                    const Value& zero) {
    if (attribute._type != std::type_index(typeid(Value)))
        return false;
    const Value sum = mean.of<Number>(
        zero, [&](std::size_t i) { return *static_cast<const Value*>(attribute._handle->At(i)); });
    *static_cast<Value*>(attribute._handle->At(to)) = sum;
    return true;
}

void fill_vertex(MeshModel& model, std::size_t to, const Mean& mean) {
    CMeshO& m = model.cm;
    CVertexO& v = m.vert[to];
    v.ImportData(m.vert[mean.nearest()]);
    const CMeshO::CoordType origin(0, 0, 0);
    v.P() = mean.of(origin, [&](std::size_t i) { return m.vert[i].cP(); });
    v.N() = mean.of(origin, [&](std::size_t i) { return m.vert[i].cN(); });
    if (v.N().Norm() > 0)
        v.N().Normalize();
    v.Q() = mean.of(Scalarm(0), [&](std::size_t i) { return m.vert[i].cQ(); });
    for (int k = 0; k < 4; ++k)
        v.C()[k] = static_cast<unsigned char>(std::lround(mean.of(
            Scalarm(0), [&](std::size_t i) { return static_cast<Scalarm>(m.vert[i].cC()[k]); })));
    if (model.hasDataMask(MeshModel::MM_VERTTEXCOORD)) {
        v.T().U() = static_cast<float>(
            mean.of(Scalarm(0), [&](std::size_t i) { return Scalarm(m.vert[i].cT().U()); }));
        v.T().V() = static_cast<float>(
            mean.of(Scalarm(0), [&](std::size_t i) { return Scalarm(m.vert[i].cT().V()); }));
    }
    bool selected = true;
    for (Index k = 0; k < 3; ++k)
        if (mean.weights[k] > 0.0)
            selected = selected && m.vert[mean.corners[static_cast<std::size_t>(k)]].IsS();
    if (selected)
        v.SetS();
    else
        v.ClearS();
    for (const CMeshO::PointerToAttribute& attribute : m.vert_attr)
        if (!mean_attribute<float, float>(attribute, to, mean, 0.0F) &&
            !mean_attribute<double, double>(attribute, to, mean, 0.0) &&
            !mean_attribute<vcg::Point3f, float>(attribute, to, mean, vcg::Point3f(0, 0, 0)) &&
            !mean_attribute<vcg::Point3d, double>(attribute, to, mean, vcg::Point3d(0, 0, 0)))
            attribute._handle->CopyValue(to, mean.nearest(), attribute._handle);
}

// The edge of the source face that edge e of a part lies on, −1 for those inside.
int source_edge(const HostRefinement::Part& part, int e) {
    for (int k = 0; k < 3; ++k)
        if (part.weights[static_cast<std::size_t>(e)][(k + 2) % 3] == 0.0 &&
            part.weights[static_cast<std::size_t>((e + 1) % 3)][(k + 2) % 3] == 0.0)
            return k;
    return -1;
}

// The coordinates that fit the textures (textures.h) are those of corners, as the wedge's own.
void split_old_uv(CMeshO& m, std::size_t to, std::size_t source, const HostRefinement::Part& part) {
    for (const char* name : {"texcoord_before_u", "texcoord_before_v"}) {
        auto values = vcg::tri::Allocator<CMeshO>::FindPerFaceAttribute<CMeshO::CoordType>(m, name);
        if (!vcg::tri::Allocator<CMeshO>::IsValidHandle(m, values))
            continue;
        const CMeshO::CoordType old = values[source];
        for (int k = 0; k < 3; ++k) {
            double sum = 0.0;
            for (int j = 0; j < 3; ++j)
                sum += part.weights[static_cast<std::size_t>(k)][j] * old[j];
            values[to][k] = static_cast<Scalarm>(sum);
        }
    }
}

// The part takes what its face has; the face's own place comes last of its parts.
void fill_part(MeshModel& model, std::size_t to, std::size_t source,
               const HostRefinement::Part& part, const std::vector<std::size_t>& vertices) {
    CMeshO& m = model.cm;
    CFaceO& f = m.face[to];
    const CFaceO& from = m.face[source];
    std::array<bool, 3> faux{};
    for (int k = 0; k < 3; ++k) {
        const int edge = source_edge(part, k);
        faux[static_cast<std::size_t>(k)] = edge >= 0 && from.IsF(edge);
    }
    std::array<Vec2, 3> uv{Vec2::Zero(), Vec2::Zero(), Vec2::Zero()};
    const bool has_uv = model.hasDataMask(MeshModel::MM_WEDGTEXCOORD);
    for (int k = 0; has_uv && k < 3; ++k)
        for (int j = 0; j < 3; ++j)
            uv[static_cast<std::size_t>(k)] += part.weights[static_cast<std::size_t>(k)][j] *
                                               Vec2(from.cWT(j).U(), from.cWT(j).V());
    if (to != source) {
        f.ImportData(from);
        for (const CMeshO::PointerToAttribute& attribute : m.face_attr)
            attribute._handle->CopyValue(to, source, attribute._handle);
    }
    split_old_uv(m, to, source, part);
    for (int k = 0; k < 3; ++k) {
        const auto corner = static_cast<std::size_t>(k);
        f.V(k) = &m.vert[vertices[static_cast<std::size_t>(part.corners[corner])]];
        if (faux[corner])
            f.SetF(k);
        else
            f.ClearF(k);
        if (has_uv) {
            f.WT(k).U() = static_cast<float>(uv[corner].x());
            f.WT(k).V() = static_cast<float>(uv[corner].y());
        }
    }
}

} // namespace

void split_faces(MeshModel& model, const HostRefinement& refinement) {
    using Allocator = vcg::tri::Allocator<CMeshO>;
    CMeshO& m = model.cm;
    std::vector<std::size_t> vertices = live_places(m.vert);
    std::vector<std::size_t> faces = live_places(m.face);
    std::size_t new_faces = 0;
    for (const HostRefinement::Part& part : refinement.parts)
        new_faces += static_cast<std::size_t>(part.face) >= faces.size() ? 1 : 0;
    const std::size_t old_vertices = m.vert.size();
    Allocator::AddVertices(m, refinement.points.size());
    try {
        Allocator::AddFaces(m, new_faces);
    } catch (...) { // memory may run out
        for (std::size_t v = old_vertices; v < m.vert.size(); ++v)
            Allocator::DeleteVertex(m, m.vert[v]);
        throw;
    }
    for (std::size_t i = 0; i < refinement.points.size(); ++i) {
        const HostRefinement::Point& point = refinement.points[i];
        Mean mean;
        mean.weights = point.weights;
        for (int k = 0; k < 3; ++k)
            mean.corners[static_cast<std::size_t>(k)] =
                vcg::tri::Index(m, m.face[faces[static_cast<std::size_t>(point.face)]].cV(k));
        vertices.push_back(old_vertices + i);
        fill_vertex(model, vertices.back(), mean);
    }
    for (std::size_t i = 0; i < new_faces; ++i)
        faces.push_back(m.face.size() - new_faces + i);
    for (std::size_t i = refinement.parts.size(); i-- > 0;) {
        const HostRefinement::Part& part = refinement.parts[i];
        fill_part(model, faces[static_cast<std::size_t>(part.face)],
                  faces[static_cast<std::size_t>(part.source)], part, vertices);
    }
    model.clearDataMask(MeshModel::MM_FACEFACETOPO | MeshModel::MM_VERTFACETOPO);
    vcg::tri::UpdateFlags<CMeshO>::FaceBorderFromNone(m);
    vcg::tri::UpdateFlags<CMeshO>::VertexBorderFromFaceBorder(m);
}

} // namespace devseg::host
