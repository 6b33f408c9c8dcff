// From a flattened mesh to the bytes of a pattern file.
#include "filters/export_pattern.h"

#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "devseg/pattern/pieces.h"
#include "devseg/plane/plane.h"
#include "sheet/cover.h"
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
        return make_pattern_file(mesh, uv, {}, {mesh, {}, {}, {}, {}}, options, progress);
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

// Two squares of side 10 that meet in a valley of 90 degrees, seen from where the normals point; as
// one island, or as two that lie apart.
Model valley(bool is_one_island) {
    declare::HostMesh host;
    host.geometry.points = {{0, 0, 0},   {0, 10, 0},  {-10, 10, 0},
                            {-10, 0, 0}, {0, 10, 10}, {0, 0, 10}};
    host.geometry.faces = {{0, 1, 2}, {0, 2, 3}, {1, 0, 5}, {1, 5, 4}};
    const double apart = is_one_island ? 0.0 : 8.0;
    for (const Triangle& t : host.geometry.faces) {
        std::array<Vec2, 3> corners;
        const bool stands = t[2] == 5 || t[2] == 4;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& p = host.geometry.points[t[k]];
            corners[k] = Vec2(stands ? p.z() + apart : p.x(), p.y());
        }
        host.wedge_uv.push_back(corners);
    }
    return Model(host);
}

sheet::PatternLayout laid_out(const Model& model, const sheet::ExportOptions& options) {
    Progress progress;
    const sheet::ExportOptions resolved = sheet::resolved(options);
    return sheet::lay_out_pattern(pattern::make_pattern(model.mesh, model.uv, resolved, progress),
                                  resolved, progress);
}

struct FoldCounts {
    std::size_t mountains = 0;
    std::size_t valleys = 0;
};

FoldCounts folds_of(const sheet::PatternLayout& layout) {
    FoldCounts counts;
    for (const sheet::SheetPiece& piece : layout.pieces) {
        counts.mountains += piece.mountains.size();
        counts.valleys += piece.valleys.size();
    }
    return counts;
}

TEST(Folds, BasesOfTabsFoldAsTheSurfaceDoes) {
    sheet::ExportOptions options;
    options.preset = sheet::PatternPreset::papercraft;
    options.mm_per_unit = 5.0;
    for (const bool is_one_island : {true, false})
        for (const bool mirror : {false, true}) {
            options.mirror = mirror;
            const FoldCounts counts = folds_of(laid_out(valley(is_one_island), options));
            EXPECT_EQ(counts.valleys, mirror ? 0U : 1U) << is_one_island;
            EXPECT_EQ(counts.mountains, mirror ? 1U : 0U) << is_one_island;
        }
    // On a cube all are mountains.
    const FoldCounts cube = folds_of(laid_out(flattened(shapes::cube(2)), options));
    options.mirror = false;
    const FoldCounts as_it_is = folds_of(laid_out(flattened(shapes::cube(2)), options));
    EXPECT_EQ(as_it_is.valleys, 0U);
    EXPECT_GT(as_it_is.mountains, 5U);
    EXPECT_EQ(cube.valleys, as_it_is.mountains);
}

TEST(Mirror, EachSheetIsSeenFromItsBack) {
    const Model model = flattened(shapes::capped_cylinder(12, 4));
    for (const char* page : {"none", "a4"})
        for (const sheet::PatternPreset preset :
             {sheet::PatternPreset::papercraft, sheet::PatternPreset::sewing}) {
            sheet::ExportOptions options;
            options.preset = preset;
            options.mm_per_unit = 80.0;
            options.page = page;
            options.curve_mm = 0.2;
            const sheet::PatternLayout plain = laid_out(model, options);
            options.mirror = true;
            const sheet::PatternLayout mirrored = laid_out(model, options);
            ASSERT_EQ(plain.sheets.size(), mirrored.sheets.size());
            for (std::size_t i = 0; i < plain.pieces.size(); ++i) {
                const sheet::SheetPiece& a = plain.pieces[i];
                const sheet::SheetPiece& b = mirrored.pieces[i];
                ASSERT_EQ(a.sheet, b.sheet);
                const double width = plain.sheets[a.sheet].size.x();
                EXPECT_NEAR(b.box().min().x(), width - a.box().max().x(), 1e-9);
                EXPECT_NEAR(b.box().min().y(), a.box().min().y(), 1e-9);
                EXPECT_NEAR(plane::signed_area(b.cut.front()), plane::signed_area(a.cut.front()),
                            1e-6);
                EXPECT_EQ(a.mountains.size(), b.valleys.size());
                const Vec2 p(3.0, 4.0); // the frame says where all of it went
                EXPECT_NEAR(b.frame(p).x(), width - a.frame(p).x(), 1e-9);
                EXPECT_NEAR(b.frame(p).y(), a.frame(p).y(), 1e-9);
            }
        }
}

TEST(Notes, SayWhatThereWasNoRoomFor) {
    const Model model = flattened(shapes::sphere(1));
    sheet::ExportOptions options;
    options.preset = sheet::PatternPreset::papercraft;
    options.mm_per_unit = 0.5;
    options.output_file = "pattern.pdf";
    const PatternFile file = model.file(options);
    EXPECT_GT(file.untabbed_seams, 0);
    EXPECT_EQ(file.unnamed_pieces, 1);
    const auto said = [&](const std::string& part) {
        return std::any_of(file.notes.begin(), file.notes.end(), [&](const std::string& note) {
            return note.find(part) != std::string::npos;
        });
    };
    EXPECT_TRUE(said(std::to_string(file.untabbed_seams) + " of " + std::to_string(file.seams)));
    EXPECT_TRUE(said("no glue tab"));
    EXPECT_TRUE(said("no room for a name"));
    // The cover has them as well.
    Progress progress;
    const sheet::ExportOptions resolved = sheet::resolved(options);
    const pattern::Pattern pattern =
        pattern::make_pattern(model.mesh, model.uv, resolved, progress);
    const sheet::PatternLayout layout = sheet::lay_out_pattern(pattern, resolved, progress);
    std::string cover;
    for (const writers::DocumentPage& page : sheet::cover_pages(
             pattern, layout, sheet::printed_pages(layout, sheet::draw_sheets(layout, resolved)),
             resolved, ""))
        for (const writers::DrawingLayer& layer : page.marks)
            for (const writers::DrawingText& text : layer.texts)
                cover += text.text;
    EXPECT_NE(cover.find("no glue tab"), std::string::npos);
    EXPECT_NE(cover.find("No room for their names: pieces P01"), std::string::npos);
}

} // namespace
} // namespace devseg::exporting
