// Between the host's mesh (VCG) and the plain arrays of the core. Reads and writes live elements
// only, in their order; the same sources serve both scalar types and all versions of the host.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "devseg/declare/filter.h"
#include "host/meshlab_api.h"

namespace devseg::host {

inline mesh::RawMesh read_raw_mesh(const CMeshO& m) {
    mesh::RawMesh raw;
    std::vector<Index> live(m.vert.size(), -1);
    raw.points.reserve(static_cast<std::size_t>(m.vn));
    for (std::size_t v = 0; v < m.vert.size(); ++v)
        if (!m.vert[v].IsD()) {
            live[v] = static_cast<Index>(raw.points.size());
            const auto& p = m.vert[v].cP();
            raw.points.emplace_back(p[0], p[1], p[2]);
        }
    raw.faces.reserve(static_cast<std::size_t>(m.fn));
    for (const auto& f : m.face)
        if (!f.IsD())
            raw.faces.push_back({live[vcg::tri::Index(m, f.cV(0))],
                                 live[vcg::tri::Index(m, f.cV(1))],
                                 live[vcg::tri::Index(m, f.cV(2))]});
    return raw;
}

/// Wedge texture coordinates of the live faces; the mesh must have them enabled.
inline std::vector<std::array<Vec2, 3>> read_wedge_uv(const CMeshO& m) {
    std::vector<std::array<Vec2, 3>> uv;
    uv.reserve(static_cast<std::size_t>(m.fn));
    for (const auto& f : m.face)
        if (!f.IsD())
            uv.push_back({Vec2(f.cWT(0).U(), f.cWT(0).V()), Vec2(f.cWT(1).U(), f.cWT(1).V()),
                          Vec2(f.cWT(2).U(), f.cWT(2).V())});
    return uv;
}

/// A custom scalar attribute of the live faces; empty when the mesh does not have it.
inline std::vector<double> read_face_attribute(CMeshO& m, const std::string& name) {
    std::vector<double> values;
    auto handle = vcg::tri::Allocator<CMeshO>::FindPerFaceAttribute<Scalarm>(m, name);
    if (!vcg::tri::Allocator<CMeshO>::IsValidHandle(m, handle))
        return values;
    values.reserve(static_cast<std::size_t>(m.fn));
    for (std::size_t f = 0; f < m.face.size(); ++f)
        if (!m.face[f].IsD())
            values.push_back(static_cast<double>(handle[f]));
    return values;
}

using FaceAttribute = CMeshO::PerFaceAttributeHandle<Scalarm>;

inline FaceAttribute face_attribute(CMeshO& m, const std::string& name) {
    return vcg::tri::Allocator<CMeshO>::GetPerFaceAttribute<Scalarm>(m, name);
}

inline void write_face_attribute(CMeshO& m, FaceAttribute handle, const std::vector<int>& values) {
    std::size_t i = 0;
    for (std::size_t f = 0; f < m.face.size(); ++f)
        if (!m.face[f].IsD())
            handle[f] = static_cast<Scalarm>(values[i++]);
}

/// Selected edges and vertices; empty where none is.
inline void read_edges_and_vertices(const CMeshO& m, declare::HostMesh& host) {
    bool any = false;
    for (const auto& f : m.face) {
        if (f.IsD())
            continue;
        int bits = 0;
        for (int k = 0; k < 3; ++k)
            bits |= f.IsFaceEdgeS(k) ? 1 << k : 0;
        host.edge_selected.push_back(static_cast<std::uint8_t>(bits));
        any = any || bits != 0;
    }
    if (!any)
        host.edge_selected.clear();
    any = false;
    for (const auto& v : m.vert) {
        if (v.IsD())
            continue;
        host.vertex_selected.push_back(v.IsS() ? 1 : 0);
        any = any || v.IsS();
    }
    if (!any)
        host.vertex_selected.clear();
}

/// The face attribute material_id; without it the number of each face's texture image; empty
/// where the mesh has neither.
inline std::vector<Index> read_materials(MeshModel& model) {
    std::vector<Index> materials;
    for (const double id : read_face_attribute(model.cm, "material_id"))
        materials.push_back(id >= -1e9 && id <= 1e9 ? static_cast<Index>(id) : -1);
    if (!materials.empty() || !model.hasDataMask(MeshModel::MM_WEDGTEXCOORD))
        return materials;
    for (const auto& f : model.cm.face)
        if (!f.IsD())
            materials.push_back(f.cWT(0).N());
    return materials;
}

inline declare::HostMesh read_host_mesh(MeshModel& model) {
    declare::HostMesh host;
    host.geometry = read_raw_mesh(model.cm);
    host.chart_id = read_face_attribute(model.cm, "chart_id");
    host.seam_edges = read_face_attribute(model.cm, "seam_edges");
    if (model.hasDataMask(MeshModel::MM_WEDGTEXCOORD))
        host.wedge_uv = read_wedge_uv(model.cm);
    const bool has_color = model.hasDataMask(MeshModel::MM_FACECOLOR);
    bool is_any_selected = false;
    for (const auto& f : model.cm.face) {
        if (f.IsD())
            continue;
        host.face_selected.push_back(f.IsS() ? 1 : 0);
        is_any_selected = is_any_selected || f.IsS();
        if (has_color)
            host.face_color.push_back({f.cC()[0], f.cC()[1], f.cC()[2]});
    }
    if (!is_any_selected)
        host.face_selected.clear();
    read_edges_and_vertices(model.cm, host);
    host.face_material = read_materials(model);
    return host;
}

/// Moves the live vertices, with what depends on them.
inline void write_points(CMeshO& m, const std::vector<Vec3>& points) {
    std::size_t i = 0;
    for (auto& v : m.vert)
        if (!v.IsD()) {
            const Vec3& p = points[i++];
            v.P() = CMeshO::CoordType(static_cast<Scalarm>(p.x()), static_cast<Scalarm>(p.y()),
                                      static_cast<Scalarm>(p.z()));
        }
    vcg::tri::UpdateBounding<CMeshO>::Box(m);
    vcg::tri::UpdateNormal<CMeshO>::PerVertexNormalizedPerFace(m);
}

/// What the result has for face i. Colours, quality, selection and texture stay where the filter
/// did not touch the face.
template <class HostFace>
void write_face(const declare::HostResult& result, std::size_t i, HostFace& f) {
    const bool stays = !result.untouched.empty() && result.untouched[i] != 0;
    if (!result.face_quality.empty() && !stays)
        f.Q() = static_cast<Scalarm>(result.face_quality[i]);
    if (!result.face_color.empty() && !stays) {
        const declare::Color& c = result.face_color[i];
        f.C() = vcg::Color4b(c[0], c[1], c[2], 255);
    }
    if (!result.face_selected.empty() && !stays) {
        if (result.face_selected[i] != 0)
            f.SetS();
        else
            f.ClearS();
    }
    for (int k = 0; k < 3; ++k) {
        if (!result.wedge_uv.empty() && !stays) {
            const Vec2& p = result.wedge_uv[i][static_cast<std::size_t>(k)];
            f.WT(k).U() = static_cast<float>(p.x());
            f.WT(k).V() = static_cast<float>(p.y());
            f.WT(k).N() = 0;
        }
        if (!result.seam_edges.empty()) {
            if ((result.seam_edges[i] >> k) & 1)
                f.SetFaceEdgeS(k);
            else
                f.ClearFaceEdgeS(k);
        }
    }
}

/// Writes what the result holds, after the filter has succeeded; returns the bits of what changed.
inline unsigned write_host_result(MeshModel& model, const declare::HostResult& result) {
    unsigned changed = MeshModel::MM_NONE;
    const auto enable = [&](int mask) {
        model.updateDataMask(mask);
        changed |= static_cast<unsigned>(mask);
    };
    if (!result.face_quality.empty())
        enable(MeshModel::MM_FACEQUALITY);
    if (!result.face_color.empty())
        enable(MeshModel::MM_FACECOLOR);
    if (!result.wedge_uv.empty())
        enable(MeshModel::MM_WEDGTEXCOORD);
    if (!result.chart_id.empty()) {
        // Both before either is written: memory may run out here, and nowhere below.
        const FaceAttribute chart_id = face_attribute(model.cm, "chart_id");
        const FaceAttribute seam_edges = face_attribute(model.cm, "seam_edges");
        write_face_attribute(model.cm, chart_id, result.chart_id);
        write_face_attribute(model.cm, seam_edges, result.seam_edges);
        changed |= MeshModel::MM_FACEFLAG;
    }
    if (!result.points.empty()) {
        write_points(model.cm, result.points);
        changed |= MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;
    }
    if (!result.face_selected.empty())
        changed |= MeshModel::MM_FACEFLAGSELECT;
    std::size_t i = 0;
    for (auto& f : model.cm.face)
        if (!f.IsD())
            write_face(result, i++, f);
    return changed;
}

/// Fills a new, empty mesh.
inline void fill_layer(MeshModel& model, const declare::LayerMesh& layer) {
    CMeshO& m = model.cm;
    model.updateDataMask(MeshModel::MM_FACECOLOR | MeshModel::MM_FACEQUALITY);
    auto vertex = vcg::tri::Allocator<CMeshO>::AddVertices(m, layer.geometry.points.size());
    for (const Vec3& p : layer.geometry.points) {
        vertex->P() = CMeshO::CoordType(static_cast<Scalarm>(p.x()), static_cast<Scalarm>(p.y()),
                                        static_cast<Scalarm>(p.z()));
        ++vertex;
    }
    auto face = vcg::tri::Allocator<CMeshO>::AddFaces(m, layer.geometry.faces.size());
    for (std::size_t f = 0; f < layer.geometry.faces.size(); ++f, ++face) {
        for (int k = 0; k < 3; ++k)
            face->V(k) = &m.vert[layer.geometry.faces[f][static_cast<std::size_t>(k)]];
        const declare::Color& c = layer.face_color[f];
        face->C() = vcg::Color4b(c[0], c[1], c[2], 255);
        face->Q() = static_cast<Scalarm>(layer.face_quality[f]);
    }
    for (const auto& [name, values] : layer.face_attributes)
        write_face_attribute(m, face_attribute(m, name), values);
    // The model's own method for this has another name in every version of the host.
    vcg::tri::UpdateBounding<CMeshO>::Box(m);
    vcg::tri::UpdateNormal<CMeshO>::PerVertexNormalizedPerFace(m);
}

/// Selects exactly the given live faces, so that the user sees which ones are meant.
inline void select_faces(CMeshO& m, const std::vector<Index>& faces) {
    std::vector<bool> wanted(static_cast<std::size_t>(m.fn), false);
    for (const Index f : faces)
        wanted[static_cast<std::size_t>(f)] = true;
    std::size_t i = 0;
    for (auto& f : m.face) {
        if (f.IsD())
            continue;
        if (wanted[i++])
            f.SetS();
        else
            f.ClearS();
    }
}

} // namespace devseg::host
