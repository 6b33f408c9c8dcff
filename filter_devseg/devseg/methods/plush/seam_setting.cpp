#include "devseg/methods/plush/seam_setting.h"

#include <cmath>

#include "devseg/methods/plush/thin_tips.h"

namespace devseg::plush {

double saved_cost(const SeamSetting& setting, const SeamMarks& before, const SeamMarks& after,
                  PatchTester& tester, const Progress& progress) {
    const Mesh& mesh = setting.mesh();
    const SeamCost& cost = tester.cost();
    std::vector<Index> beside;
    double saved = 0.0;
    for (const HalfEdge h : mesh.all_half_edges())
        if (before[h] != after[h]) {
            beside.push_back(face_of(h));
            saved += (before[h] != 0 ? 0.5 : -0.5) * setting.straight_cost[h];
        }
    const std::vector<std::vector<Index>> old_patches = patches_of(mesh, before, beside);
    const std::vector<std::vector<Index>> new_patches = patches_of(mesh, after, beside);
    saved += cost.per_patch *
             (static_cast<double>(old_patches.size()) - static_cast<double>(new_patches.size()));
    saved += cost.per_corner * (static_cast<double>(count_acute_corners(setting, before)) -
                                static_cast<double>(count_acute_corners(setting, after)));
    for (const std::vector<Index>& patch : old_patches)
        saved += cost.per_narrow * setting.tester.judge(patch, before, progress).narrow;
    for (const std::vector<Index>& patch : new_patches) {
        if (saved <= 0.0)
            return saved;
        const Verdict verdict = tester.judge(patch, after, progress);
        if (!verdict.accepted)
            return -infinite;
        saved -= cost.per_narrow * verdict.narrow;
    }
    return saved;
}

} // namespace devseg::plush
