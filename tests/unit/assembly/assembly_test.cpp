// The order in which pieces are put together, checked by a walk that knows nothing of how it was
// found: it only sews what each step says.
#include "devseg/assembly/assembly.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "devseg/assembly/limbs.h"
#include "devseg/base/errors.h"
#include "devseg/pattern/pieces.h"
#include "unit/host_checks.h"
#include "unit/shapes.h"

namespace devseg::assembly {
namespace {

pattern::Pattern pattern_of(declare::HostMesh host, double height_mm) {
    checks::take_charts(host, checks::run("Charts: Cut to Disks", host));
    host.wedge_uv = checks::run("Charts: Flatten", host).wedge_uv;
    const mesh::GatedMesh gated = mesh::gate_mesh(host.geometry, {0.0, true});
    CornerUv uv;
    for (const Face f : gated.mesh.all_faces())
        for (Index k = 0; k < 3; ++k)
            uv.push_back(host.wedge_uv[gated.source_face[f]][gated.source_corner(f, k)]);
    pattern::PatternOptions options;
    options.height_mm = height_mm;
    Progress progress;
    return pattern::make_pattern(gated.mesh, uv, options, progress);
}

pattern::Pattern pattern_of(const mesh::RawMesh& raw, double height_mm, int charts) {
    declare::HostMesh host = checks::host_of(raw);
    checks::take_charts(host, checks::run("Segmentation: Variational Shape Approximation", host,
                                          {{"charts_number", charts}}));
    return pattern_of(std::move(host), height_mm);
}

const std::vector<Vec3> limb_axes{Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1),
                                  Vec3(0, 0, -1)};

// The axis of the limb that the direction is on, or −1.
Index limb_at(const Vec3& direction) {
    for (std::size_t i = 0; i < limb_axes.size(); ++i)
        if (direction.normalized().dot(limb_axes[i]) > std::cos(0.45))
            return static_cast<Index>(i);
    return -1;
}

// A ball of radius 1 with five limbs that reach to 3.
mesh::RawMesh ball_with_limbs() {
    mesh::RawMesh raw = shapes::sphere(5);
    for (Vec3& p : raw.points)
        if (const Index i = limb_at(p); i >= 0) {
            const double t = std::min(1.0, (0.45 - std::acos(p.dot(limb_axes[at(i)]))) / 0.2);
            p *= 1.0 + 2.0 * t;
        }
    return raw;
}

Vec3 middle_of(const mesh::RawMesh& raw, const Triangle& face) {
    return (raw.points[at(face[0])] + raw.points[at(face[1])] + raw.points[at(face[2])]) / 3.0;
}

// Sews step by step. Returns what is wrong with the order, or nothing.
std::string fault_of(const pattern::Pattern& pattern, const Assembly& plan) {
    std::vector<std::set<Index>> built; // what hangs together
    for (Index p = 0; p < static_cast<Index>(pattern.pieces.size()); ++p)
        built.push_back({p});
    std::set<Index> done;
    const auto with = [&](Index piece) {
        return std::find_if(built.begin(), built.end(),
                            [&](const std::set<Index>& part) { return part.count(piece) > 0; });
    };
    for (std::size_t k = 0; k < plan.steps.size(); ++k) {
        const AssemblyStep& step = plan.steps[k];
        const std::string name = "step " + std::to_string(k + 1);
        if (step.seams.empty())
            return name + " does nothing";
        std::set<Index> touched;
        for (const Index s : step.seams) {
            const pattern::Seam& seam = pattern.seams[at(s)];
            const auto a = with(seam.sides[0].piece);
            const auto b = with(seam.sides[1].piece);
            if (a != b) {
                a->insert(b->begin(), b->end());
                built.erase(b);
            }
            touched.insert(seam.sides[0].piece);
            const bool was_open = std::any_of(plan.openings.begin(), plan.openings.end(),
                                              [&](const Opening& o) { return o.seam == s; });
            if (!done.insert(s).second && !(was_open && step.kind == StepKind::close))
                return name + " sews seam " + seam.label + " again";
        }
        const auto part = with(*touched.begin());
        for (const Index p : touched)
            if (part->count(p) == 0)
                return name + " works on parts that do not hang together";
        for (const Index p : step.pieces)
            if (part->count(p) == 0)
                return name + " leaves a piece loose that it adds";
    }
    if (done.size() != pattern.seams.size())
        return "seams are left";
    return "";
}

// What hangs together by seams, told by one of its pieces.
std::vector<Index> parts_of(const pattern::Pattern& pattern) {
    std::vector<Index> part(pattern.pieces.size());
    std::iota(part.begin(), part.end(), Index{0});
    for (bool changed = true; changed;) {
        changed = false;
        for (const pattern::Seam& seam : pattern.seams) {
            Index& a = part[at(seam.sides[0].piece)];
            Index& b = part[at(seam.sides[1].piece)];
            changed = changed || a != b;
            a = b = std::min(a, b);
        }
    }
    return part;
}

// Whether each watertight part is closed once, by its own last step, and the last step of all
// closes one. What is left open must be open until then.
std::string closing_fault_of(const pattern::Pattern& pattern, const Assembly& plan) {
    const std::vector<Index> part = parts_of(pattern);
    std::set<Index> watertight(part.begin(), part.end());
    for (const HalfEdge h : pattern.mesh.all_half_edges())
        if (pattern.mesh.twin[h] < 0)
            watertight.erase(part[at(pattern.face_piece[face_of(h)])]);
    std::set<Index> done;
    std::set<Index> closed;
    for (const AssemblyStep& step : plan.steps) {
        const Index here = part[at(pattern.seams[at(step.seams.front())].sides[0].piece)];
        if (closed.count(here) > 0)
            return "a solid is worked on after it was closed";
        if (step.kind == StepKind::close) {
            closed.insert(here);
            for (const Index s : step.seams)
                if (done.count(s) > 0 &&
                    std::none_of(plan.openings.begin(), plan.openings.end(),
                                 [&](const Opening& o) { return o.seam == s && !o.is_whole; }))
                    return "nothing was left open";
        }
        done.insert(step.seams.begin(), step.seams.end());
    }
    if (closed != watertight)
        return "closed are " + std::to_string(closed.size()) + " of " +
               std::to_string(watertight.size()) + " solids";
    if (!closed.empty() && plan.steps.back().kind != StepKind::close)
        return "the last step closes nothing";
    return "";
}

// Both side by side.
mesh::RawMesh beside(mesh::RawMesh all, const mesh::RawMesh& more) {
    const auto first = static_cast<Index>(all.points.size());
    double right = 0.0;
    for (const Vec3& p : all.points)
        right = std::max(right, p.x());
    for (const Vec3& p : more.points)
        all.points.push_back(p + Vec3(right + 2.0, 0.0, 0.0));
    for (const Triangle& t : more.faces)
        all.faces.push_back({t[0] + first, t[1] + first, t[2] + first});
    return all;
}

TEST(Assembly, EachSolidIsClosedByItsOwnLastStep) {
    const mesh::RawMesh parts =
        beside(beside(beside(shapes::cube(3), shapes::cylinder_tube(12, 4)), shapes::sphere(2)),
               shapes::hemisphere(12, 4));
    for (const Craft craft : {Craft::sewing, Craft::papercraft})
        for (const int charts : {4, 9, 16}) {
            const pattern::Pattern pattern = pattern_of(parts, 200.0, charts);
            Progress progress;
            const Assembly plan = plan_assembly(pattern, craft, progress);
            EXPECT_EQ(fault_of(pattern, plan), "") << charts;
            EXPECT_EQ(closing_fault_of(pattern, plan), "") << charts;
            EXPECT_EQ(std::count_if(
                          plan.steps.begin(), plan.steps.end(),
                          [](const AssemblyStep& step) { return step.kind == StepKind::close; }),
                      2);
        }
}

TEST(Assembly, ASolidOfOnePieceIsGluedShutInTheEnd) {
    for (const auto& raw : {shapes::sphere(2), shapes::capped_cylinder(12, 4)}) {
        const pattern::Pattern pattern = pattern_of(raw, 200.0, 1);
        ASSERT_EQ(pattern.pieces.size(), 1U);
        Progress progress;
        const Assembly plan = plan_assembly(pattern, Craft::papercraft, progress);
        EXPECT_EQ(fault_of(pattern, plan), "");
        EXPECT_EQ(closing_fault_of(pattern, plan), "");
    }
}

TEST(Assembly, EveryStepJoinsWhatSharesASeam) {
    for (const Craft craft : {Craft::sewing, Craft::papercraft})
        for (const auto& [raw, charts] :
             {std::pair(shapes::cube(3), 6), std::pair(shapes::cube(3), 2),
              std::pair(shapes::sphere(2), 8), std::pair(shapes::torus(16, 10), 7),
              std::pair(shapes::capped_cylinder(12, 4), 1),
              std::pair(shapes::cylinder_tube(12, 4), 4)}) {
            const pattern::Pattern pattern = pattern_of(raw, 200.0, charts);
            Progress progress;
            const Assembly plan = plan_assembly(pattern, craft, progress);
            EXPECT_EQ(fault_of(pattern, plan), "") << charts;
            for (const Index section : plan.section)
                EXPECT_TRUE(section >= 0 && section < plan.section_count);
        }
}

TEST(Assembly, OnlyTheLastStepClosesASolid) {
    const pattern::Pattern pattern = pattern_of(shapes::cube(3), 200.0, 6);
    Progress progress;
    const Assembly sewn = plan_assembly(pattern, Craft::sewing, progress);
    ASSERT_EQ(sewn.openings.size(), 1U);
    const Opening& opening = sewn.openings.front();
    EXPECT_GE(opening.to - opening.from, least_opening - 1e-9);
    EXPECT_LE(opening.to - opening.from, most_opening + 1e-9);
    EXPECT_LE(opening.to, pattern.seams[at(opening.seam)].sides[0].length);
    const auto closes = [](const Assembly& plan) {
        return std::count_if(plan.steps.begin(), plan.steps.end(),
                             [](const AssemblyStep& step) { return step.kind == StepKind::close; });
    };
    EXPECT_EQ(closes(sewn), 1);
    EXPECT_EQ(sewn.steps.back().kind, StepKind::close);
    EXPECT_EQ(sewn.steps.back().seams, std::vector<Index>{opening.seam});
    const Assembly glued = plan_assembly(pattern, Craft::papercraft, progress);
    EXPECT_TRUE(glued.openings.empty());
    EXPECT_EQ(glued.steps.back().kind, StepKind::close);
    EXPECT_EQ(glued.steps.back().seams.size(), 4U) << "a side of the cube is the lid";
}

TEST(Assembly, WhatIsOpenNeedsNoOpening) {
    const pattern::Pattern pattern = pattern_of(shapes::cylinder_tube(12, 4), 200.0, 2);
    Progress progress;
    EXPECT_TRUE(plan_assembly(pattern, Craft::sewing, progress).openings.empty());
}

TEST(Assembly, SmallToysAreClosedAlongAWholeSeam) {
    const pattern::Pattern pattern = pattern_of(shapes::cube(3), 20.0, 6);
    Progress progress;
    const Assembly plan = plan_assembly(pattern, Craft::sewing, progress);
    ASSERT_EQ(plan.openings.size(), 1U);
    EXPECT_TRUE(plan.openings.front().is_whole);
    EXPECT_EQ(fault_of(pattern, plan), "");
    EXPECT_EQ(plan.seam_step[at(plan.openings.front().seam)],
              static_cast<Index>(plan.steps.size()));
}

TEST(Assembly, LimbsAreFound) {
    const mesh::GatedMesh gated = mesh::gate_mesh(ball_with_limbs(), {0.0, true});
    Progress progress;
    const Limbs limbs = find_limbs(gated.mesh, progress);
    ASSERT_EQ(limbs.count, 5);
    // Each lies on one axis, and holds what is beyond the ball there.
    std::map<Index, Index> axis_of;
    const mesh::RawMesh raw = ball_with_limbs();
    for (const Face f : gated.mesh.all_faces()) {
        const Vec3 middle = middle_of(raw, raw.faces[at(gated.source_face[f])]);
        const Index limb = limbs.of_face[f];
        if (middle.norm() > 1.9) {
            EXPECT_EQ(axis_of.emplace(limb, limb_at(middle)).first->second, limb_at(middle));
        }
    }
    for (const Face f : gated.mesh.all_faces()) // and ends where the ball begins
        if (const Index limb = limbs.of_face[f]; limb >= 0) {
            const Vec3 middle = middle_of(raw, raw.faces[at(gated.source_face[f])]);
            EXPECT_GT(middle.normalized().dot(limb_axes.at(at(axis_of[limb]))), std::cos(0.75));
        }
    EXPECT_EQ(axis_of.size(), 5U);
    EXPECT_EQ(axis_of.count(-1), 0U);
    // Balls and tubes have none.
    for (const auto& smooth : {shapes::sphere(3), shapes::torus(24, 12)})
        EXPECT_EQ(find_limbs(mesh::gate_mesh(smooth, {0.0, true}).mesh, progress).count, 0);
}

TEST(Assembly, PiecesOfALimbAreOneSection) {
    declare::HostMesh host = checks::host_of(ball_with_limbs());
    for (const Triangle& face : host.geometry.faces) {
        // Two halves of each limb and of the ball, and no limb is split along the same plane.
        const Vec3 middle = middle_of(host.geometry, face);
        const Index limb = limb_at(middle);
        const double side = limb < 0 ? middle.x() + 0.1 : limb < 2 ? middle.y() : middle.x();
        host.chart_id.push_back(2.0 * (limb + 1) + (side > 0.0 ? 1.0 : 0.0));
    }
    host.seam_edges.assign(host.chart_id.size(), 0.0);
    const pattern::Pattern pattern = pattern_of(host, 300.0);
    ASSERT_EQ(pattern.pieces.size(), 12U);
    Progress progress;
    const Assembly plan = plan_assembly(pattern, Craft::sewing, progress);
    EXPECT_EQ(fault_of(pattern, plan), "");
    std::map<Index, std::set<Index>> pieces; // of sections
    for (std::size_t p = 0; p < plan.section.size(); ++p)
        pieces[plan.section[p]].insert(static_cast<Index>(p));
    EXPECT_EQ(pieces.size(), 6U);
    for (const auto& [section, here] : pieces)
        EXPECT_EQ(here.size(), 2U);
    // Limbs are sewn first, by themselves, and then to the ball.
    std::vector<Index> attached;
    for (const AssemblyStep& step : plan.steps) {
        if (step.kind == StepKind::attach)
            attached.push_back(step.section);
        EXPECT_TRUE(attached.empty() || step.kind == StepKind::attach ||
                    step.kind == StepKind::close);
    }
    EXPECT_EQ(std::set<Index>(attached.begin(), attached.end()), (std::set<Index>{0, 1, 2, 3, 4}));
}

TEST(Assembly, CanBeCancelled) {
    const pattern::Pattern pattern = pattern_of(shapes::cube(3), 200.0, 6);
    Progress progress([](double, const char*) { return false; });
    EXPECT_THROW(
        {
            auto part = progress.part("assembly", 1.0);
            plan_assembly(pattern, Craft::sewing, part);
        },
        Cancelled);
}

TEST(Sections, NamesAreLikeThoseOfColumns) {
    EXPECT_EQ(section_name(0), "A");
    EXPECT_EQ(section_name(25), "Z");
    EXPECT_EQ(section_name(26), "AA");
}

} // namespace
} // namespace devseg::assembly
