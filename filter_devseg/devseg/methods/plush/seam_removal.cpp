#include "devseg/methods/plush/seam_removal.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>
#include <optional>
#include <random>
#include <set>
#include <utility>

#include "devseg/base/parallel.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

using Key = std::pair<Index, Index>; // lowest half-edge and number of edges of a segment

Key key_of(const Mesh& mesh, const SeamSegment& segment) {
    Index lowest = segment.half_edges.front();
    for (const HalfEdge h : segment.half_edges)
        lowest = std::min<Index>({lowest, h, mesh.twin[h]});
    return {lowest, static_cast<Index>(segment.half_edges.size())};
}

// Segments and the patches between them.
struct Network {
    Network(const SeamSetting& setting, const SeamMarks& seam)
        : surface(setting.surface), mesh(setting.mesh()),
          segments(find_segments(mesh, seam, setting.hard, setting.weight)),
          label(find_patches(mesh, seam).label), faces(patches_of(mesh, seam)),
          area(faces.size(), 0.0), segment_of(mesh.twin.size(), 0),
          degree(seam_degrees(mesh, seam)) {
        for (const Face f : mesh.all_faces())
            area[label[f]] += mesh.face_areas[f];
        for (std::size_t i = 0; i < segments.size(); ++i)
            for (const HalfEdge h : segments[i].half_edges)
                segment_of[h] = segment_of[mesh.twin[h]] = i;
    }

    HalfEdge first(std::size_t i) const { return segments[i].half_edges.front(); }
    std::size_t image_of(std::size_t i) const {
        return surface.is_symmetric() ? segment_of[surface.image[first(i)]] : i;
    }
    // Whether the segment runs across the plane: its mirror image is itself, the other way round.
    bool is_crossing(std::size_t i) const {
        return surface.is_symmetric() && image_of(i) == i && !surface.is_on_plane(first(i));
    }

    Index left(std::size_t i) const { return label[face_of(first(i))]; }
    Index right(std::size_t i) const { return label[face_of(mesh.twin[first(i)])]; }
    std::pair<Index, Index> beside(std::size_t i) const { return std::minmax({left(i), right(i)}); }
    double smaller_area(std::size_t i) const { return std::min(area[left(i)], area[right(i)]); }
    double size(std::size_t i) const { return smaller_area(i) / mesh.total_area; }
    // Large patches with many slits would be hard to sew, and seams easily fail on another surface.
    bool is_large_together(std::size_t i, const RemovalOptions& options) const {
        return left(i) != right(i) &&
               area[left(i)] + area[right(i)] > options.most_together * mesh.total_area;
    }

    // Of the segments between the same two patches.
    bool is_longest_between(std::size_t i) const {
        const std::pair<Index, Index> sides = beside(i);
        if (sides.first == sides.second)
            return false;
        for (std::size_t k = 0; k < segments.size(); ++k)
            if (beside(k) == sides && !segments[k].is_hard &&
                (segments[k].length > segments[i].length ||
                 (segments[k].length == segments[i].length && k < i)))
                return false;
        return true;
    }

    // 1 where a segment ends inside a patch, −1 where it starts there, 0 for neither.
    int free_end(std::size_t i) const {
        if (degree[mesh.target(segments[i].half_edges.back())] == 1)
            return 1;
        return degree[mesh.origin(first(i))] == 1 ? -1 : 0;
    }

    const WorkingSurface& surface;
    const Mesh& mesh;
    std::vector<SeamSegment> segments;
    std::vector<Index> label;              // #F: patches
    std::vector<std::vector<Index>> faces; // of each patch
    std::vector<double> area;
    std::vector<std::size_t> segment_of; // 3 #F, of seam edges
    std::vector<Index> degree;           // #V
};

// Which segments go, in what order, and which parts of them.
struct Policy {
    std::function<bool(const Network&, std::size_t)> may_go;
    std::function<double(const Network&, std::size_t)> rank; // the highest go first
    // Parts that could go, in the order in which they are tried.
    std::function<std::vector<Window>(const Network&, std::size_t)> windows;
};

// A segment that goes with its mirror image, or parts of both, and the patches beside them.
struct Removal {
    std::size_t segment = 0;
    std::size_t image = 0;                   // the same where a segment is its own mirror image
    std::vector<Index> patches;              // that are joined or lose a dart
    std::vector<std::vector<Index>> choices; // half-edges that could go, the best ones first
    std::size_t taken = 0;                   // the first choice that is accepted, or their number
};

// One choice of one removal of a round.
struct Choice {
    std::size_t removal = 0;
    std::size_t index = 0;
};

// The first choices of all removals, then the second ones, and so on.
std::vector<Choice> in_turn(const std::vector<Removal>& round) {
    std::vector<Choice> turns;
    for (std::size_t i = 0; i < round.size(); ++i)
        for (std::size_t index = 0; index < round[i].choices.size(); ++index)
            turns.push_back({i, index});
    std::stable_sort(turns.begin(), turns.end(),
                     [](const Choice& a, const Choice& b) { return a.index < b.index; });
    return turns;
}

class Remover {
public:
    Remover(const SeamSetting& setting, const Policy& policy, const RemovalOptions& options,
            SeamMarks& seam, Progress& progress)
        : s_(setting), mesh_(setting.mesh()), policy_(policy), options_(options), seam_(seam),
          progress_(progress) {}

    Index run() {
        std::optional<Network> network(std::in_place, s_, seam_);
        const double start = std::max(1.0, static_cast<double>(network->segments.size()));
        int rounds = 0;
        bool changed = true;
        for (int pass = 0; pass < tuning.most_passes && changed; ++pass) {
            failed_.clear();
            changed = false;
            for (; rounds < s_.max_rounds; ++rounds) {
                std::vector<Removal> round = next_round(*network);
                if (round.empty())
                    break;
                try_choices(*network, round);
                bool removed = false;
                for (const Removal& removal : round)
                    removed = apply(*network, removal) || removed;
                if (removed)
                    network.emplace(s_, seam_);
                changed = changed || removed;
                const auto left = static_cast<double>(network->segments.size());
                progress_.update(std::min(0.95, 1.0 - left / start));
            }
        }
        return trials_;
    }

private:
    std::vector<Removal> next_round(const Network& network) {
        std::vector<std::pair<double, std::size_t>> queue;
        for (std::size_t i = 0; i < network.segments.size(); ++i)
            if (!network.segments[i].is_hard &&
                failed_.count(key_of(mesh_, network.segments[i])) == 0 &&
                policy_.may_go(network, i))
                queue.emplace_back(-policy_.rank(network, i), i);
        std::sort(queue.begin(), queue.end());
        std::vector<std::uint8_t> taken(network.faces.size(), 0);
        std::vector<Removal> round;
        std::vector<std::uint8_t> used(network.segments.size(), 0);
        for (const auto& [price, i] : queue) {
            if (round.size() >= tuning.batch)
                break;
            if (used[i] != 0)
                continue;
            Removal removal{i, network.image_of(i), {}, {}, 0};
            bool is_free = true;
            for (const std::size_t k : {i, removal.image}) {
                used[k] = 1;
                for (const Index p : {network.left(k), network.right(k)})
                    if (std::find(removal.patches.begin(), removal.patches.end(), p) ==
                        removal.patches.end()) {
                        removal.patches.push_back(p);
                        is_free = is_free && taken[p] == 0;
                    }
            }
            for (const Index p : removal.patches)
                taken[p] = 1;
            if (is_free) {
                find_choices(network, removal);
                round.push_back(std::move(removal));
            }
        }
        return round;
    }

    void find_choices(const Network& network, Removal& removal) const {
        for (const Window& window : policy_.windows(network, removal.segment)) {
            std::vector<Index> edges = edges_within(network.segments[removal.segment], window);
            if (!edges.empty() && (removal.choices.empty() || edges != removal.choices.back()))
                removal.choices.push_back(std::move(edges));
        }
        removal.taken = removal.choices.size();
    }

    // Of the segment, and their mirror images.
    std::vector<Index> edges_within(const SeamSegment& segment, const Window& window) const {
        std::vector<Index> edges;
        double before = 0.0;
        for (const HalfEdge h : segment.half_edges) {
            const double middle = (before + 0.5 * mesh_.edge_length(h)) / segment.length;
            before += mesh_.edge_length(h);
            if (middle < window.from || middle > window.to)
                continue;
            edges.push_back(h);
            if (s_.surface.is_symmetric())
                edges.push_back(s_.surface.image[h]);
        }
        return edges;
    }

    // Later choices are tried before it is known that they are needed, which changes nothing but
    // the time.
    void try_choices(const Network& network, std::vector<Removal>& round) {
        const std::vector<Choice> turns = in_turn(round);
        auto trying = progress_.part(0.0); // the rounds know how far they are
        std::mutex mutex;
        parallel_for(
            static_cast<int>(turns.size()),
            [&](int i) {
                const Choice& choice = turns[static_cast<std::size_t>(i)];
                Removal& removal = round[choice.removal];
                {
                    const std::lock_guard<std::mutex> lock(mutex);
                    if (removal.taken < choice.index)
                        return;
                }
                if (!works(network, removal, removal.choices[choice.index]))
                    return;
                const std::lock_guard<std::mutex> lock(mutex);
                removal.taken = std::min(removal.taken, choice.index);
            },
            trying);
        for (const Removal& removal : round)
            trials_ += static_cast<Index>(std::min(removal.taken + 1, removal.choices.size()));
    }

    // Whether the patches that there are with other marks, in place of the removal's, are
    // developable.
    bool works(const Network& network, const Removal& removal,
               const std::vector<Index>& edges) const {
        PatchTester& tester =
            network.is_large_together(removal.segment, options_) ? s_.strict_tester : s_.tester;
        SeamMarks marks = seam_;
        mark(mesh_, edges, 0, marks);
        std::vector<Index> open;
        for (const Index p : removal.patches)
            open.insert(open.end(), network.faces[p].begin(), network.faces[p].end());
        std::sort(open.begin(), open.end());
        const std::vector<std::vector<Index>> patches = patches_of(mesh_, marks, open);
        return tester.accepts_all(patches, marks, progress_) &&
               makes_no_neck(network, removal, patches, marks);
    }

    // Whether none of the patches is narrower somewhere than it may be, or than one was before.
    bool makes_no_neck(const Network& network, const Removal& removal,
                       const std::vector<std::vector<Index>>& patches,
                       const SeamMarks& marks) const {
        double least = s_.tester.least_width();
        if (least == 0.0)
            return true;
        for (const Index p : removal.patches)
            least = std::min(least, s_.tester.judge(network.faces[p], seam_, progress_).width);
        return std::all_of(patches.begin(), patches.end(), [&](const std::vector<Index>& patch) {
            return s_.tester.judge(patch, marks, progress_).width >= least;
        });
    }

    bool apply(const Network& network, const Removal& removal) {
        const bool is_accepted = removal.taken < removal.choices.size();
        if (is_accepted)
            mark(mesh_, removal.choices[removal.taken], 0, seam_);
        else
            for (const std::size_t k : {removal.segment, removal.image})
                failed_.insert(key_of(mesh_, network.segments[k]));
        return is_accepted;
    }

    const SeamSetting& s_;
    const Mesh& mesh_;
    const Policy& policy_;
    const RemovalOptions& options_;
    SeamMarks& seam_;
    Progress& progress_;
    std::set<Key> failed_;
    Index trials_ = 0;
};

// A factor near 1 that depends on the seed and on where the segment is; 1 for the seed 0.
double jitter(const Network& network, std::size_t i, int random_seed) {
    if (random_seed == 0)
        return 1.0;
    const auto [lowest, count] = key_of(network.mesh, network.segments[i]);
    std::minstd_rand random(static_cast<std::uint32_t>(random_seed) * 2654435761U +
                            static_cast<std::uint32_t>(lowest));
    random.discard(2);
    return 0.8 + 0.4 * static_cast<double>(random()) / std::minstd_rand::max();
}

// The least natural segments first, those of small patches before others.
double unnatural_first(const Network& network, std::size_t i, const RemovalOptions& options) {
    return jitter(network, i, options.random_seed) *
           std::pow(network.segments[i].weight, options.weight_power) *
           std::pow(network.size(i), -options.size_power);
}

} // namespace

Index remove_seams(const SeamSetting& setting, const RemovalOptions& options, SeamMarks& seam,
                   Progress& progress) {
    const Policy whole_segments{
        [](const Network&, std::size_t) { return true; },
        [&](const Network& network, std::size_t i) { return unnatural_first(network, i, options); },
        [](const Network&, std::size_t) { return std::vector<Window>{Window{}}; }};
    return Remover(setting, whole_segments, options, seam, progress).run();
}

Index join_patches(const SeamSetting& setting, const RemovalOptions& options, SeamMarks& seam,
                   Progress& progress) {
    const auto windows = [&](const Network& network, std::size_t i) {
        if (network.is_large_together(i, options))
            return std::vector<Window>{Window{}}; // nearly flat patches need no darts
        const double least =
            options.least_neck * std::sqrt(network.smaller_area(i)) / network.segments[i].length;
        std::vector<Window> result;
        for (const Window& w : tuning.join_windows)
            if (w.to - w.from == 1.0 ||
                (w.to - w.from >= least && (!network.is_crossing(i) || w.from == 1.0 - w.to)))
                result.push_back(w);
        return result;
    };
    const Policy joins{
        [&](const Network& network, std::size_t i) {
            return network.smaller_area(i) <= options.most_area * network.mesh.total_area &&
                   network.is_longest_between(i);
        },
        [](const Network& network, std::size_t i) {
            const SeamSegment& segment = network.segments[i];
            return segment.length * segment.weight / std::max(network.size(i), tuning.tiny);
        },
        windows};
    return Remover(setting, joins, options, seam, progress).run();
}

Index shorten_darts(const SeamSetting& setting, SeamMarks& seam, Progress& progress) {
    const RemovalOptions options;
    const Policy darts{
        [](const Network& network, std::size_t i) {
            return !network.segments[i].is_loop && network.left(i) == network.right(i) &&
                   network.free_end(i) != 0;
        },
        [&](const Network& network, std::size_t i) { return unnatural_first(network, i, options); },
        [](const Network& network, std::size_t i) {
            std::vector<Window> windows;
            for (const Window& w : tuning.dart_windows)
                windows.push_back(network.free_end(i) < 0 ? Window{1.0 - w.to, 1.0 - w.from} : w);
            return windows;
        }};
    return Remover(setting, darts, options, seam, progress).run();
}

} // namespace devseg::plush
