// Thin tips and tongues of patches, and acute corners where seams meet.
#pragma once

#include "devseg/methods/plush/patch_tester.h"

namespace devseg::plush {

/// Gives what hangs on a patch and is narrower than `width` (internal units), the acute corners
/// where seams meet, teeth and strips, to the patch beside it, where both stay developable disks:
/// a seam across the tongue takes the place of a longer one along it. Returns how many changes were
/// tried.
Index give_tongues_away(const SeamSetting& setting, double width, SeamMarks& seam,
                        Progress& progress);

/// Two seams that leave one place nearly side by side, with nothing but a thin tip of a patch
/// between them: there cloth bunches up, and a small change of the boundary moves the map much.
struct AcuteCorner {
    Index first = -1;  // half-edge that leaves the corner; the tip lies on its left
    Index second = -1; // the one that leaves on the tip's other side
    double cosine = 0.0;
};

/// Those below `max_angle` (radians), measured over `reach` (internal units) along the seams, the
/// most acute one first. `hard` (3 #F or empty) parts segments.
std::vector<AcuteCorner> find_acute_corners(const Mesh& mesh, const SeamMarks& seam,
                                            const SeamMarks& hard, double reach, double max_angle);

/// Lets junctions slide along one of their seams: the tip goes to the patch beyond the other seam,
/// as little of it as makes the corner blunt, where both patches stay developable disks and no
/// other corner becomes acute. Short darts that leave their seam at an acute angle are taken away
/// where they are not needed. Returns how many changes were tried.
Index blunt_acute_corners(const SeamSetting& setting, SeamMarks& seam, Progress& progress);

} // namespace devseg::plush
