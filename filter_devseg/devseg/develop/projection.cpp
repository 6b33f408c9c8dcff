#include "devseg/develop/projection.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace devseg::develop {

namespace {

struct Tuning {
    double largest_tear = 0.3; // change of an edge vector in a step, as a share of its length
    int tear_rounds = 20;
    int guard_rounds = 8;     // halvings of steps at places that they would spoil
    int chords = 4;           // steps with one factorization
    double free_defect = 0.1; // radians that a defect may grow to in a step
    double least_damping = 1e-13;
    double least_gain = 0.2; // share of the way that is left to go, for a full step
    double faster = 0.05;    // factor of a damping that is needed no more
};
constexpr Tuning tuning;

Vec3 face_vector(const std::vector<Vec3>& p, const Triangle& t) {
    return (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
}

} // namespace

Projection::Projection(const Mesh& mesh, const std::vector<Index>& point_of,
                       std::vector<double> ease)
    : mesh_(&mesh), point_of_(point_of), ease_(std::move(ease)), constraints_(mesh, {}, point_of) {
    Index count = 0;
    for (const Index p : point_of)
        count = std::max(count, p + 1);
    points_.assign(at(count), Vec3::Zero());
    for (std::size_t v = 0; v < point_of.size(); ++v)
        points_[point_of[v]] = mesh.points[v];
    for (const Triangle& t : mesh.faces)
        faces_.push_back({point_of[t[0]], point_of[t[1]], point_of[t[2]]});
    for (const Triangle& t : faces_)
        start_normal_.push_back(face_vector(points_, t));
    valence_.assign(points_.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const HalfEdge twin = mesh.twin[h];
        if (twin > h)
            continue;
        edges_.push_back({point_of[mesh.origin(h)], point_of[mesh.target(h)]});
        ++valence_[edges_.back()[0]];
        ++valence_[edges_.back()[1]];
        if (twin >= 0)
            hinges_.push_back(
                {face_of(h), face_of(twin),
                 mesh.face_normals[face_of(h)].dot(mesh.face_normals[face_of(twin)])});
    }
    edge_ = std::sqrt(4.0 / std::sqrt(3.0) * mesh.total_area / mesh.face_count());
}

void Projection::constrain(const std::vector<Index>& vertices,
                           const std::vector<std::uint8_t>& fixed) {
    mobility_ = ease_;
    for (double& m : mobility_)
        m *= edge_ * edge_;
    for (std::size_t p = 0; p < fixed.size(); ++p)
        if (fixed[p] != 0)
            mobility_[p] = 0.0;
    constraints_ = AngleConstraints(*mesh_, vertices, point_of_);
    defects_ = constraints_.defects(points_);
    analysed_ = false;
    block_.assign(points_.size(), 0);
}

int Projection::longest_block() const {
    return *std::max_element(block_.begin(), block_.end());
}

int Projection::block(Index r) const {
    int longest = 0;
    for (const Index* p = constraints_.first_point(r); p != constraints_.last_point(r); ++p)
        longest = std::max(longest, block_[*p]);
    return longest;
}

// Neighbours may move far together, but not far from each other.
void Projection::limit_tearing(Field& step) const {
    std::vector<std::uint8_t> torn;
    for (int round = 0; round < tuning.tear_rounds; ++round) {
        torn.assign(points_.size(), 0);
        bool any = false;
        for (const auto& [a, b] : edges_)
            if ((step[a] - step[b]).squaredNorm() > tuning.largest_tear * tuning.largest_tear *
                                                        (points_[a] - points_[b]).squaredNorm()) {
                torn[a] = torn[b] = 1;
                any = true;
            }
        if (!any)
            return;
        Field sum(points_.size(), Vec3::Zero());
        for (const auto& [a, b] : edges_) {
            sum[a] += step[b];
            sum[b] += step[a];
        }
        for (std::size_t p = 0; p < step.size(); ++p)
            if (torn[p] != 0 && mobility_[p] > 0.0)
                step[p] = 0.5 * step[p] + 0.4 / valence_[p] * sum[p];
    }
}

bool Projection::face_spoilt(std::size_t f, const Field& moved) const {
    const Vec3 now = face_vector(points_, faces_[f]);
    const Vec3 then = face_vector(moved, faces_[f]);
    const double size = then.norm();
    const double before = now.norm();
    const double start = start_normal_[f].norm();
    if (then.dot(now) < 0.5 * size * before || size < 0.5 * before)
        return true; // too much for one step
    if (size < 0.05 * start && size < before)
        return true;
    const double turned = then.dot(start_normal_[f]) / (size * start);
    return turned < 0.1 && turned < now.dot(start_normal_[f]) / (before * start);
}

bool Projection::edge_folded(std::size_t e, const Field& moved) const {
    const Hinge& hinge = hinges_[e];
    const auto cosine = [&](const Field& p) {
        const Vec3 a = face_vector(p, faces_[hinge.f]);
        const Vec3 b = face_vector(p, faces_[hinge.g]);
        return a.dot(b) / std::sqrt(a.squaredNorm() * b.squaredNorm());
    };
    const double then = cosine(moved);
    return then < -0.94 && then < hinge.cosine && then < cosine(points_);
}

// Marks the points of all that the move spoils, as far as a point of it has changed; returns how
// many faces, edges and vertices that are.
Index Projection::mark_bad(const Field& moved, const Eigen::VectorXd* after,
                           const std::vector<std::uint8_t>& changed,
                           std::vector<std::uint8_t>& bad) const {
    Index count = 0;
    const auto mark = [&](const Index* first, const Index* last) {
        ++count;
        for (; first != last; ++first)
            bad[*first] = 1;
    };
    const auto has_changed = [&](const Triangle& t) {
        return (changed[t[0]] | changed[t[1]] | changed[t[2]]) != 0;
    };
    if (after != nullptr)
        for (Index r = 0; r < after->size(); ++r)
            if (std::abs((*after)[r]) > std::max(tuning.free_defect, 1.2 * std::abs(defects_[r])))
                mark(constraints_.first_point(r), constraints_.last_point(r));
    for (std::size_t f = 0; f < faces_.size(); ++f)
        if (has_changed(faces_[f]) && face_spoilt(f, moved))
            mark(faces_[f].data(), faces_[f].data() + 3);
    for (std::size_t e = 0; e < hinges_.size(); ++e) {
        const Triangle& s = faces_[hinges_[e].f];
        const Triangle& t = faces_[hinges_[e].g];
        if ((has_changed(s) || has_changed(t)) && edge_folded(e, moved)) {
            mark(s.data(), s.data() + 3);
            mark(t.data(), t.data() + 3);
        }
    }
    return count;
}

// Moves by `step`, by less where that would spoil a face or a vertex; returns the defects there.
Eigen::VectorXd Projection::guarded(const Field& step, bool limit_defects, Field& moved) {
    for (std::size_t p = 0; p < step.size(); ++p)
        moved[p] = points_[p] + step[p];
    Eigen::VectorXd after = constraints_.defects(moved);
    std::vector<std::uint8_t> changed(points_.size(), 1);
    std::vector<double> share(points_.size(), 1.0);
    std::vector<std::uint8_t> bad;
    for (int round = 0;; ++round) {
        bad.assign(points_.size(), 0);
        const Index count = mark_bad(moved, limit_defects ? &after : nullptr, changed, bad);
        if (count_blocks_)
            for (std::size_t p = 0; p < bad.size(); ++p)
                block_[p] = bad[p] != 0 ? block_[p] + 1 : 0;
        count_blocks_ = false;
        if (count == 0 || round == tuning.guard_rounds)
            return after;
        for (std::size_t p = 0; p < bad.size(); ++p)
            if (bad[p] != 0) {
                share[p] *= round + 2 < tuning.guard_rounds ? 0.5 : 0.0;
                moved[p] = points_[p] + share[p] * step[p];
            }
        constraints_.update_defects(moved, bad, after);
        changed = bad;
    }
}

bool Projection::chord_steps() {
    Eigen::VectorXd lambda = solver_.solve(defects_);
    double size = defects_.dot(lambda); // the squared length of the step that is left to go [D11]
    double gain = 1.0;
    double taken = 0.0;
    count_blocks_ = true;
    fast_ = false;
    Field moved(points_.size());
    for (int chord = 0; chord < tuning.chords && gain > 0.0 && (chord == 0 || gain < 0.5);
         ++chord) {
        Field step = constraints_.displacement(mobility_, lambda);
        limit_tearing(step);
        gain = 0.0;
        for (double share = 1.0; share > 0.2 && gain == 0.0; share *= 0.5) {
            const Eigen::VectorXd after = guarded(step, true, moved);
            Eigen::VectorXd next = solver_.solve(after);
            const double left = after.dot(next);
            if (left < size * (1.0 - tuning.least_gain * share)) {
                gain = left / size;
                fast_ = fast_ || (share == 1.0 && gain < 0.1);
                taken = share;
                points_ = moved;
                defects_ = after;
                lambda = std::move(next);
                size = left;
                if (left <= 0.0)
                    break;
            }
            for (Vec3& d : step)
                d *= 0.5;
        }
    }
    if (taken >= 0.5)
        damping_ = std::max(tuning.least_damping, damping_ * (fast_ ? tuning.faster : 0.3));
    return taken > 0.0;
}

bool Projection::factorize() {
    const Normal& matrix = constraints_.normal_matrix(
        mobility_, Eigen::VectorXd::Constant(constraints_.count(), damping_));
    if (!analysed_)
        solver_.analyzePattern(matrix);
    analysed_ = true;
    solver_.factorize(matrix);
    return solver_.info() == Eigen::Success;
}

// Whether a step could not gain enough even if all were linear: damping holds smooth defects, as
// those of a fine sphere, where they are.
bool Projection::is_held() const {
    const Eigen::VectorXd lambda = solver_.solve(defects_);
    const double left = damping_ * damping_ * lambda.dot(solver_.solve(lambda));
    return left > (1.0 - tuning.least_gain) * defects_.dot(lambda);
}

bool Projection::step() {
    constraints_.linearise(points_);
    bool solved = factorize();
    while (solved && damping_ > tuning.least_damping && is_held()) {
        damping_ *= tuning.faster;
        solved = factorize();
    }
    const bool done = solved && chord_steps();
    if (!done)
        damping_ *= 8.0;
    return done;
}

void Projection::relax_blocked(int rounds) {
    Field step(points_.size(), Vec3::Zero());
    std::vector<std::uint8_t> area(points_.size(), 0);
    for (const auto& [a, b] : edges_)
        if (block_[a] >= rounds || block_[b] >= rounds)
            area[a] = area[b] = 1;
    Field relaxed = points_;
    for (int round = 0; round < 3; ++round) {
        Field sum(points_.size(), Vec3::Zero());
        for (const auto& [a, b] : edges_) {
            sum[a] += relaxed[b];
            sum[b] += relaxed[a];
        }
        for (std::size_t p = 0; p < relaxed.size(); ++p)
            if (area[p] != 0 && mobility_[p] > 0.0)
                relaxed[p] = 0.5 * relaxed[p] + 0.5 / valence_[p] * sum[p];
    }
    for (std::size_t p = 0; p < step.size(); ++p)
        step[p] = relaxed[p] - points_[p];
    Field moved(points_.size());
    defects_ = guarded(step, false, moved);
    points_ = moved;
}

} // namespace devseg::develop
