#include "devseg/methods/plush/patch_tester.h"
#include "devseg/methods/plush/piece_shape.h"

#include <algorithm>
#include <utility>

namespace devseg::plush {

Verdict PatchTester::judge(const std::vector<Index>& faces, const std::vector<std::uint8_t>& seam,
                           const Progress& progress) {
    std::vector<Index> patch = faces;
    std::sort(patch.begin(), patch.end());
    if (surface_.is_symmetric()) {
        std::vector<Index> image;
        for (const Face f : patch)
            image.push_back(surface_.face_image(f));
        std::sort(image.begin(), image.end());
        patch = std::min(patch, image);
    }
    std::vector<Index> key;
    for (const Face f : patch)
        key.push_back(8 * f + 4 * seam[3 * f] + 2 * seam[3 * f + 1] + seam[3 * f + 2]);
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        const auto found = known_.find(key);
        if (found != known_.end())
            return found->second;
    }
    const judge::ClothTrial trial =
        judge::try_cloth(surface_.mesh, patch, seam, limits_, false, progress);
    Verdict verdict{trial.accepted, least_width_};
    if (least_width_ > 0.0 && !trial.outline.empty())
        verdict.width = narrowest_neck(trial.outline, least_width_).width;
    const std::lock_guard<std::mutex> lock(mutex_);
    known_.emplace(std::move(key), verdict);
    return verdict;
}

bool PatchTester::accepts(const std::vector<Index>& faces, const std::vector<std::uint8_t>& seam,
                          const Progress& progress) {
    return judge(faces, seam, progress).accepted;
}

bool PatchTester::accepts_all(const std::vector<std::vector<Index>>& patches,
                              const std::vector<std::uint8_t>& seam, const Progress& progress) {
    return std::all_of(patches.begin(), patches.end(),
                       [&](const auto& faces) { return accepts(faces, seam, progress); });
}

} // namespace devseg::plush
