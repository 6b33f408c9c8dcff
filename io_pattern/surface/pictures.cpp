#include "surface/pictures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Dense>

#include "devseg/atlas/texture_transfer.h"
#include "devseg/base/errors.h"
#include "devseg/base/parallel.h"
#include "devseg/plane/baking.h"
#include "devseg/plane/plane.h"
#include "sheet/drawing_plan.h"
#include "writers/text.h"

namespace devseg::surface {

namespace {

struct Tuning {
    double pixel = 25.4 / 300.0;   // mm, what printers show
    double most_pixels = 1.5e8;    // of all pictures: half a gigabyte
    double spare = 4.0;            // pixels beyond the clip, for blocks of JPEG that lie across it
    double texels_per_pixel = 2.0; // that bilinear sampling still sees
};
constexpr Tuning tuning;

constexpr plane::Color paper = {255, 255, 255};

// Barycentric coordinates of a point in the plane of a face; faces that no cut goes through have
// its corners.
Vec3 place_in(const Mesh& mesh, Face f, const Vec3& p) {
    for (Index k = 0; k < 3; ++k)
        if (p == mesh.points[mesh.faces[f][at(k)]])
            return Vec3::Unit(k);
    const Vec3& origin = mesh.points[mesh.faces[f][0]];
    Eigen::Matrix<double, 3, 2> edges;
    edges << mesh.points[mesh.faces[f][1]] - origin, mesh.points[mesh.faces[f][2]] - origin;
    const Vec2 along = edges.colPivHouseholderQr().solve(p - origin);
    return {1.0 - along.sum(), along.x(), along.y()};
}

// The faces of the pattern as triangles with colours, in millimetres of the pattern.
class Faces {
public:
    Faces(const pattern::Pattern& pattern, const Look& look, double pixel)
        : pattern_(pattern), look_(look), images_(look.images) {
        std::vector<double> texels(images_.size(), 0.0);
        std::vector<double> pixels(images_.size(), 0.0);
        for (const Face f : pattern.mesh.all_faces()) {
            triangles_.push_back(triangle(f, pixels, texels));
            if (triangles_.back().source != nullptr)
                images_used_.push_back(look.page[pattern.source_face[f]]);
            else
                images_used_.push_back(-1);
        }
        // Finer images than the print would flicker.
        for (std::size_t i = 0; i < images_.size(); ++i)
            for (double share = texels[i] * pixel * pixel / std::max(pixels[i], 1e-300);
                 share > tuning.texels_per_pixel * tuning.texels_per_pixel &&
                 std::min(images_[i].width, images_[i].height) > 1;
                 share *= 0.25)
                images_[i] = plane::halved(images_[i]);
        for (std::size_t f = 0; f < triangles_.size(); ++f)
            if (images_used_[f] >= 0)
                triangles_[f].source = &images_[at(images_used_[f])];
    }
    Faces(const Faces&) = delete;
    Faces& operator=(const Faces&) = delete;

    const plane::BakedTriangle& operator[](Face f) const { return triangles_[at(f)]; }

private:
    // Areas are added for its image, in pixels of the image and in square millimetres.
    plane::BakedTriangle triangle(Face f, std::vector<double>& paper_area,
                                  std::vector<double>& image_area) const {
        const Face source = pattern_.source_face[f];
        plane::BakedTriangle result;
        if (look_.uv)
            result.source = atlas::image_of({*look_.uv, look_.page, look_.images}, source);
        for (Index k = 0; k < 3; ++k) {
            result.place[at(k)] = pattern_.corner_place[3 * f + k];
            const Vec3 weights =
                place_in(look_.mesh, source, pattern_.mesh.points[pattern_.mesh.faces[f][at(k)]]);
            if (look_.corner_color.empty())
                result.color[at(k)] = Vec3::Constant(255.0);
            for (Index i = 0; i < 3; ++i) {
                if (result.source != nullptr)
                    result.uv[at(k)] += weights[i] * (*look_.uv)[3 * source + i];
                if (!look_.corner_color.empty())
                    for (Index c = 0; c < 3; ++c)
                        result.color[at(k)][c] +=
                            weights[i] * look_.corner_color[at(3 * source + i)][at(c)];
            }
        }
        if (result.source == nullptr)
            return result;
        const std::size_t page = at(look_.page[source]);
        const auto area = [](const std::array<Vec2, 3>& c) {
            return std::abs(plane::triangle_area(c[0], c[1], c[2]));
        };
        paper_area[page] += area(result.place);
        image_area[page] += area(result.uv) * look_.images[page].width * look_.images[page].height;
        return result;
    }

    const pattern::Pattern& pattern_;
    const Look& look_;
    std::vector<plane::Image> images_;
    std::vector<Index> images_used_; // #F
    std::vector<plane::BakedTriangle> triangles_;
};

// The picture's place and its clip, without pixels.
writers::DrawingImage frame_of(const sheet::SheetPiece& piece, double bleed) {
    writers::DrawingImage image;
    image.owner = piece.name;
    Eigen::AlignedBox2d box;
    for (const std::vector<Vec2>& ring :
         bleed > 0.0 ? sheet::grown_rings(piece.cut, bleed) : piece.cut) {
        box.extend(plane::box_of(ring));
        image.clip.push_back({ring, true});
    }
    image.low = box.min();
    image.size = box.sizes();
    return image;
}

void paint(const sheet::SheetPiece& piece, const std::vector<Index>& faces, const Faces& all,
           double pixel, double reach, writers::DrawingImage& image) {
    image.columns = std::max(1, static_cast<int>(std::ceil(image.size.x() / pixel)));
    image.rows = std::max(1, static_cast<int>(std::ceil(image.size.y() / pixel)));
    image.size = pixel * Vec2(image.columns, image.rows);
    plane::Baking baking(image.columns, image.rows);
    for (const Index f : faces) {
        plane::BakedTriangle triangle = all[f];
        for (Vec2& p : triangle.place)
            p = (piece.frame(p) - image.low) / pixel;
        baking.add(triangle, 0.0);
    }
    baking.spread(reach / pixel + tuning.spare, paper);
    image.rgb = baking.take().rgb;
}

} // namespace

double print_pixel(double area) {
    return std::max(tuning.pixel, std::sqrt(area / tuning.most_pixels));
}

std::vector<std::string> add_pictures(const pattern::Pattern& pattern,
                                      const sheet::PatternLayout& layout,
                                      const sheet::ExportOptions& options, const Look& look,
                                      Progress& progress, writers::Drawing& drawing) {
    if (look.is_empty())
        throw InvalidParameter(
            "texture: expected None for a model without textures and colours of its "
            "own, found Automatic; leave texture out");
    const sheet::DrawingPlan plan = sheet::plan_drawing(layout, options.scale_check);
    std::vector<sheet::SheetPiece> pieces = layout.pieces;
    double area = 0.0;
    for (sheet::SheetPiece& piece : pieces) {
        piece.move({1.0, 0.0, plan.sheets[piece.sheet]});
        drawing.images.push_back(frame_of(piece, options.bleed()));
        area += drawing.images.back().size.prod();
    }
    const double pixel = print_pixel(area);
    const Faces all(pattern, look, pixel);
    std::vector<std::vector<Index>> faces(pattern.pieces.size());
    for (const Face f : pattern.mesh.all_faces())
        if (pattern.face_piece[f] >= 0)
            faces[at(pattern.face_piece[f])].push_back(f);
    // Pointed corners of allowances reach twice as far.
    const double reach = options.bleed() + std::max(0.0, options.kerf_mm) +
                         2.0 * std::max(options.glue_tabs ? options.tab_depth_mm : 0.0,
                                        options.allowance().largest());
    parallel_for(
        static_cast<int>(pieces.size()),
        [&](int i) {
            paint(pieces[at(i)], faces[at(pieces[at(i)].piece)], all, pixel, reach,
                  drawing.images[at(i)]);
        },
        progress);
    std::vector<std::string> notes;
    if (look.lost_images() > 0)
        notes.push_back(std::to_string(look.lost_images()) + " of " +
                        std::to_string(look.images.size()) +
                        " textures could not be read: their faces are printed in the colours of "
                        "the model, or white");
    if (pixel > tuning.pixel)
        notes.push_back("the print has " + writers::number_text(25.4 / pixel, 0) +
                        " pixels for an inch: 300 would be too many on a pattern of this size");
    return notes;
}

} // namespace devseg::surface
