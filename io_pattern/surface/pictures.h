// What the model's surface looks like, printed on the pieces.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/pattern/pattern.h"
#include "devseg/plane/image.h"
#include "sheet/export_options.h"
#include "sheet/layout.h"
#include "writers/drawing.h"

namespace devseg::surface {

/// The surface of a mesh: images where a face has one, else the colours of its corners.
struct Look {
    const Mesh& mesh;
    const std::optional<CornerUv>& uv; // 3 #F, of the images
    const std::vector<Index>& page;    // #F: position in `images`
    const std::vector<plane::Image>& images;
    const std::vector<plane::Color>& corner_color; // 3 #F, or empty

    /// Images that could not be read.
    Index lost_images() const {
        return static_cast<Index>(
            std::count_if(images.begin(), images.end(),
                          [](const plane::Image& image) { return image.is_empty(); }));
    }
    bool is_empty() const {
        return (at(lost_images()) == images.size() || !uv) && corner_color.empty();
    }
};

/// Adds a picture for each piece to the drawing of the layout, 300 pixels for an inch, or fewer for
/// drawings of several square metres: inside of the cut lines and a bleed around them. What lies
/// beyond the faces, such as tabs, has the colour of the nearest place of the piece. Faces without
/// colours are white. Returns notes for the user. Throws InvalidParameter where
/// nothing has a colour, and Cancelled.
std::vector<std::string> add_pictures(const pattern::Pattern& pattern,
                                      const sheet::PatternLayout& layout,
                                      const sheet::ExportOptions& options, const Look& look,
                                      Progress& progress, writers::Drawing& drawing);

/// The side of a pixel of pictures that cover an area together (mm²), mm.
double print_pixel(double area);

} // namespace devseg::surface
