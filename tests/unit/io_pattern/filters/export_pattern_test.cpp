// From a flattened mesh to the bytes of a pattern file.
#include "filters/export_pattern.h"

#include <gtest/gtest.h>

#include "devseg/pattern/pieces.h"
#include "devseg/plane/plane.h"
#include "sheet/layout.h"
#include "unit/host_checks.h"
#include "unit/shapes.h"

namespace devseg::exporting {
namespace {

// A mesh behind the gate with its texture coordinates.
struct Model {
    explicit Model(const declare::HostMesh& host) {
        const mesh::GatedMesh gated = mesh::gate_mesh(host.geometry, {0.0, true});
        mesh = gated.mesh;
        for (const Face f : mesh.all_faces())
            for (Index k = 0; k < 3; ++k)
                uv.push_back(host.wedge_uv[gated.source_face[f]][gated.source_corner(f, k)]);
    }
    PatternFile file(sheet::ExportOptions options) const {
        if (options.output_file.empty())
            options.output_file = "pattern.svg";
        Progress progress;
        return make_pattern_file(mesh, uv, options, progress);
    }

    Mesh mesh;
    CornerUv uv;
};

Model flattened(const mesh::RawMesh& raw) {
    declare::HostMesh host = checks::host_of(raw);
    host.wedge_uv = checks::run("Charts: Flatten", host).wedge_uv;
    return Model(host);
}

// Closed surfaces: the whole outline of their only piece is seams of the piece with itself.
TEST(Scale, PiecesOfAnySizeHaveTheSameOutline) {
    for (const mesh::RawMesh& raw : {shapes::sphere(1), shapes::tetrahedron(), shapes::cube(2),
                                     shapes::capped_cylinder(12, 4)}) {
        const Model model = flattened(raw);
        for (const double scale : {1e-6, 1e-3, 0.02, 0.1, 1.0, 100.0}) {
            SCOPED_TRACE(scale);
            sheet::ExportOptions options;
            options.mm_per_unit = scale;
            Progress progress;
            const pattern::Pattern pattern =
                pattern::make_pattern(model.mesh, model.uv, options, progress);
            const sheet::PatternLayout layout = sheet::lay_out_pattern(pattern, options, progress);
            ASSERT_EQ(layout.pieces.size(), 1U);
            const double area = pattern.pieces[0].outer.area;
            EXPECT_NEAR(plane::signed_area(layout.pieces[0].cut.front()), area, 0.02 * area);
            for (const sheet::PatternPreset preset :
                 {sheet::PatternPreset::plain, sheet::PatternPreset::papercraft}) {
                options.preset = preset;
                options.curve_mm = 0.01;
                EXPECT_EQ(model.file(options).pieces, 1);
            }
        }
    }
}

} // namespace
} // namespace devseg::exporting
