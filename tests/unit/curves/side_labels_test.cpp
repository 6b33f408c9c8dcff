#include "devseg/curves/side_labels.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::curves {
namespace {

// A plate of 6 by 2 squares in three columns of charts, and the curves between them.
struct Plate {
    Mesh mesh = checks::gated(shapes::grid(6, 2, 6.0, 2.0));
    atlas::ChartMap charts;
    std::vector<Piece> pieces;
    std::vector<Sides> sides;

    Plate() {
        std::vector<Index> label;
        for (const Vec3& p : mesh.face_centers)
            label.push_back(std::clamp(static_cast<Index>((p.x() * mesh.unit_length + 3.0) / 2.0),
                                       Index{0}, Index{2}));
        charts = atlas::make_chart_map(mesh, label, {}, false);
        for (const HalfEdge h : mesh.all_half_edges())
            if (charts.seam[h] != 0) {
                const Index left = charts.chart[face_of(h)];
                const Index right = charts.chart[mesh.across(h)];
                const Index curve = std::min(left, right);
                pieces.push_back({mesh.origin(h), mesh.target(h), curve, left});
                sides.push_back({left, right, curve});
            }
        std::sort(pieces.begin(), pieces.end());
    }

    std::vector<Index> failed(const mesh::Refinement& fine) {
        std::vector<Index> curves;
        labelled = label_sides(fine, charts, pieces, sides, curves);
        std::sort(curves.begin(), curves.end());
        curves.erase(std::unique(curves.begin(), curves.end()), curves.end());
        return curves;
    }
    atlas::ChartMap labelled;
};

TEST(SideLabels, OfCurvesOnEdgesAreThoseOfBefore) {
    Plate plate;
    ASSERT_EQ(plate.charts.count, 3);
    EXPECT_TRUE(plate.failed(mesh::refine(plate.mesh, {}, {})).empty());
    EXPECT_EQ(plate.labelled.chart, plate.charts.chart);
    EXPECT_EQ(plate.labelled.seam, plate.charts.seam);
}

// Both seams of the middle chart have become one, between its neighbours.
TEST(SideLabels, CurvesOfAChartThatIsGoneFail) {
    Plate plate;
    std::vector<Piece> left;
    for (Piece piece : plate.pieces)
        if (piece.curve == 0) {
            piece.label = piece.label == 1 ? 2 : 0;
            left.push_back(piece);
        }
    plate.pieces = left;
    EXPECT_EQ(plate.failed(mesh::refine(plate.mesh, {}, {})), (std::vector<Index>{0, 1}));
}

// A plate with a piece missing between the first two charts.
struct PlateWithGap : Plate {
    PlateWithGap() {
        const auto gap = *std::find_if(pieces.begin(), pieces.end(),
                                       [](const Piece& piece) { return piece.curve == 0; });
        pieces.erase(std::remove_if(pieces.begin(), pieces.end(),
                                    [&](const Piece& piece) {
                                        return std::minmax(piece.from, piece.to) ==
                                               std::minmax(gap.from, gap.to);
                                    }),
                     pieces.end());
    }
};

// Both charts are whole, and one part of the mesh: the gap alone tells.
TEST(SideLabels, CurvesWithAGapFail) {
    PlateWithGap plate;
    EXPECT_EQ(plate.failed(mesh::refine(plate.mesh, {}, {})), (std::vector<Index>{0}));
}

// Charts that meet although no curve ran between them: all curves of both fail.
TEST(SideLabels, CurvesThatLetOtherChartsThroughFail) {
    PlateWithGap plate;
    for (Sides& side : plate.sides)
        if (side.curve == 0)
            (side.left == 1 ? side.left : side.right) = 2;
    EXPECT_EQ(plate.failed(mesh::refine(plate.mesh, {}, {})), (std::vector<Index>{0, 1}));
}

// Faces are split, but none of the pieces that split them is an edge: their parts are labelled as
// the faces that they are of, which are fewer.
TEST(SideLabels, PartsOfFacesWhoseCurvesFailedAreLabelled) {
    Plate plate;
    const Index first = plate.mesh.vertex_count();
    std::vector<mesh::Refinement::Point> points;
    std::vector<mesh::SplitFace> splits;
    for (const Face f : plate.mesh.all_faces()) {
        const Triangle& t = plate.mesh.faces[f];
        const Vec3 middle = Vec3::Constant(1.0 / 3.0);
        const Index point = first + static_cast<Index>(points.size());
        points.push_back({f, middle});
        splits.push_back({f,
                          {t[0], t[1], t[2], point},
                          {Vec3::Unit(0), Vec3::Unit(1), Vec3::Unit(2), middle},
                          {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}}});
    }
    for (Piece& piece : plate.pieces)
        piece = {first + 0, first + 5, piece.curve, piece.label}; // far from each other
    const mesh::Refinement fine = mesh::refine(plate.mesh, points, splits);
    EXPECT_EQ(plate.failed(fine), (std::vector<Index>{0, 1}));
    ASSERT_EQ(plate.labelled.chart.size(), 3 * plate.mesh.faces.size());
    for (const mesh::Refinement::Part& part : fine.parts)
        EXPECT_EQ(plate.labelled.chart[part.face], plate.charts.chart[part.source]);
}

} // namespace
} // namespace devseg::curves
