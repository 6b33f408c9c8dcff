// What a model looks like comes to lie where its faces do.
#include "surface/pictures.h"

#include <cmath>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/pattern/pieces.h"
#include "devseg/plane/plane.h"
#include "sheet/drawing_plan.h"
#include "sheet/sheet_drawing.h"
#include "surface/registration.h"
#include "unit/host_checks.h"
#include "unit/shapes.h"

namespace devseg::surface {
namespace {

Vec3 color_at(const Vec3& p) {
    return Vec3::Constant(128.0) + 100.0 * (p / 2.0).cwiseMin(1.0).cwiseMax(-1.0);
}

// Two pictures, one with red and green along its sides, one with blue.
std::vector<plane::Image> two_images() {
    std::vector<plane::Image> images(2, plane::Image{64, 64, {}});
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            const auto along = static_cast<std::uint8_t>(4 * x);
            const auto up = static_cast<std::uint8_t>(4 * (63 - y));
            images[0].rgb.insert(images[0].rgb.end(), {along, up, 0});
            images[1].rgb.insert(images[1].rgb.end(), {0, along, 255});
        }
    return images;
}

// A flattened model with colours at its corners, or with two images.
struct Model {
    explicit Model(const mesh::RawMesh& raw, bool has_images) {
        declare::HostMesh host = checks::host_of(raw);
        host.wedge_uv = checks::run("Charts: Flatten", host).wedge_uv;
        mesh = mesh::gate_mesh(host.geometry, {0.0, true}).mesh;
        for (const Face f : mesh.all_faces())
            for (Index k = 0; k < 3; ++k) {
                uv.push_back(host.wedge_uv[at(f)][at(k)]);
                const Vec3 c = color_at(mesh.points[mesh.faces[f][at(k)]]);
                color.push_back({static_cast<std::uint8_t>(c.x()), static_cast<std::uint8_t>(c.y()),
                                 static_cast<std::uint8_t>(c.z())});
            }
        if (!has_images)
            return;
        images = two_images();
        image_uv.emplace();
        for (const Face f : mesh.all_faces()) {
            page.push_back(f % 3 - 1); // every third face has none
            for (const Vec2& p : {Vec2(0.2, 0.2), Vec2(0.8, 0.3), Vec2(0.4, 0.9)})
                image_uv->push_back(p);
        }
    }

    void draw(const sheet::ExportOptions& given) {
        options = sheet::resolved(given);
        Progress progress;
        pattern = pattern::make_pattern(mesh, uv, options, progress);
        layout = sheet::lay_out_pattern(pattern, options, progress);
        drawing = sheet::draw_sheets(layout, options);
        notes = add_pictures(pattern, layout, options, {mesh, image_uv, page, images, color},
                             progress, drawing);
    }

    // What is printed at a place of the drawing that the piece's picture shows.
    Vec3 printed(std::size_t piece, const Vec2& place) const {
        const writers::DrawingImage& image = drawing.images[piece];
        const Vec2 pixel = (place - image.low)
                               .cwiseQuotient(image.size)
                               .cwiseProduct(Vec2(image.columns, image.rows));
        const auto x = static_cast<std::ptrdiff_t>(pixel.x());
        const std::ptrdiff_t y = image.rows - 1 - static_cast<std::ptrdiff_t>(pixel.y());
        const std::uint8_t* c = image.rgb.data() + 3 * (y * image.columns + x);
        return {static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])};
    }

    // Largest difference at the middles of all faces.
    template <class Color>
    double largest_error(Color color_of_face) const {
        double worst = 0.0;
        for (const Face f : pattern.mesh.all_faces())
            for (std::size_t i = 0; i < layout.pieces.size(); ++i) {
                const sheet::SheetPiece& piece = layout.pieces[i];
                if (piece.piece != pattern.face_piece[f])
                    continue;
                Vec2 middle = Vec2::Zero();
                for (Index k = 0; k < 3; ++k)
                    middle += pattern.corner_place[3 * f + k] / 3.0;
                const Vec2 sheet =
                    sheet::plan_drawing(layout, options.scale_check).sheets[at(piece.sheet)];
                const Vec3 found = printed(i, piece.frame(middle) + sheet);
                worst = std::max(worst, (found - color_of_face(f)).cwiseAbs().maxCoeff());
            }
        return worst;
    }

    Mesh mesh;
    CornerUv uv;
    std::optional<CornerUv> image_uv;
    std::vector<Index> page;
    std::vector<plane::Image> images;
    std::vector<plane::Color> color;
    sheet::ExportOptions options;
    pattern::Pattern pattern;
    sheet::PatternLayout layout;
    writers::Drawing drawing;
    std::vector<std::string> notes;
};

sheet::ExportOptions papercraft() {
    sheet::ExportOptions options;
    options.preset = sheet::PatternPreset::papercraft;
    options.texture = sheet::SurfacePrint::automatic;
    options.mm_per_unit = 40.0;
    options.page = "a4";
    return options;
}

TEST(Pictures, FacesHaveTheColoursOfTheirCorners) {
    for (const bool mirror : {false, true})
        for (const double limit : {0.0, 45.0}) { // pieces are cut through faces
            sheet::ExportOptions options = papercraft();
            options.mirror = mirror;
            options.max_piece_mm = limit;
            Model model(shapes::sphere(2), false);
            model.draw(options);
            EXPECT_EQ(model.drawing.images.size(), model.layout.pieces.size());
            EXPECT_LE(model.largest_error([&](Face f) {
                const Mesh& m = model.pattern.mesh;
                const Triangle& t = m.faces[f];
                return color_at((m.points[t[0]] + m.points[t[1]] + m.points[t[2]]) / 3.0);
            }),
                      3.0);
        }
}

TEST(Pictures, FacesShowTheirImages) {
    Model model(shapes::cube(2), true);
    model.draw(papercraft());
    const Vec2 middle(1.4 / 3.0, 1.4 / 3.0);
    EXPECT_LE(model.largest_error([&](Face f) -> Vec3 {
        const Face source = model.pattern.source_face[f];
        if (model.page[at(source)] == 0)
            return {256.0 * middle.x() - 2.0, 256.0 * middle.y() - 2.0, 0.0};
        if (model.page[at(source)] == 1)
            return {0.0, 256.0 * middle.x() - 2.0, 255.0};
        Vec3 color = Vec3::Zero();
        for (Index k = 0; k < 3; ++k)
            for (Index c = 0; c < 3; ++c)
                color[c] += model.color[at(3 * source + k)][at(c)] / 3.0;
        return color;
    }),
              4.0);
}

TEST(Pictures, ColoursGoOnOverTabsAndBleed) {
    sheet::ExportOptions options = papercraft();
    options.bleed_mm = 1.5;
    Model model(shapes::cube(2), false);
    for (plane::Color& c : model.color)
        c = {200, 30, 10};
    model.draw(options);
    for (std::size_t i = 0; i < model.drawing.images.size(); ++i) {
        sheet::SheetPiece piece = model.layout.pieces[i];
        piece.move({1.0, 0.0, sheet::plan_drawing(model.layout, true).sheets[at(piece.sheet)]});
        for (const Vec2& p : piece.cut.front())
            EXPECT_EQ(model.printed(i, p), Vec3(200, 30, 10));
        std::vector<std::vector<Vec2>> clip;
        for (const writers::DrawingPolyline& ring : model.drawing.images[i].clip)
            clip.push_back(ring.points);
        double near = infinite;
        for (const Vec2& p : piece.cut.front())
            for (std::size_t k = 0; k < clip.front().size(); ++k)
                near = std::min(near, plane::distance(p, clip.front()[k],
                                                      clip.front()[(k + 1) % clip.front().size()]));
        EXPECT_NEAR(near, 1.5, 0.01);
    }
}

TEST(Pictures, RefuseWhatHasNoColours) {
    Model model(shapes::cube(1), false);
    model.color.clear();
    EXPECT_THROW(model.draw(papercraft()), InvalidParameter);
    Model lost(shapes::cube(1), true);
    lost.images[1] = {};
    lost.draw(papercraft());
    EXPECT_EQ(lost.notes.size(), 1U);
    lost.images[0] = {};
    lost.color.clear();
    EXPECT_THROW(lost.draw(papercraft()), InvalidParameter);
    model.color.assign(3 * model.mesh.faces.size(), {1, 2, 3});
    sheet::ExportOptions wide = papercraft();
    wide.bleed_mm = 4.0;
    EXPECT_THROW(model.draw(wide), InvalidParameter);
}

TEST(Pictures, LargePatternsHaveFewerPixels) {
    EXPECT_DOUBLE_EQ(print_pixel(2e5), 25.4 / 300.0);
    for (const double area : {2e6, 1e8})
        EXPECT_LE(area / std::pow(print_pixel(area), 2), 1.6e8);
}

TEST(Registration, MarksLieInTheMargin) {
    const auto layer = registration_marks({{Vec2(100, 0), Vec2(210, 297)}}, 10.0);
    ASSERT_EQ(layer.paths.size(), 4U);
    for (const writers::DrawingPath& path : layer.paths)
        for (const writers::DrawingPolyline& part : path.parts)
            for (const Vec2& p : part.points) {
                const Vec2 own = p - Vec2(100, 0);
                const Vec2 inset = own.cwiseMin(Vec2(210, 297) - own);
                EXPECT_GT(inset.minCoeff(), 0.0);
                EXPECT_LT(inset.maxCoeff(), 10.0);
            }
    EXPECT_THROW(registration_marks({{Vec2::Zero(), Vec2(210, 297)}}, 4.0), InvalidParameter);
}

} // namespace
} // namespace devseg::surface
