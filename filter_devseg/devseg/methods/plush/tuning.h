// The numbers of the method, by stage. Lengths are shares of the model's diagonal and areas shares
// of its surface where nothing else is said.
#pragma once

#include <array>
#include <cstddef>

#include "devseg/base/numbers.h"

namespace devseg::plush {

/// The part of a seam from one share of its length to another.
struct Window {
    double from = 0.0;
    double to = 1.0;
};

struct Tuning {
    double tiny = 1e-9;  // internal units, or a share: stands for nothing where nothing may not be
    double speck = 2e-3; // smaller pieces are left out, and smaller ends are no limbs

    // Symmetry.
    double symmetric_within = 0.03; // animals that stand still are nearer to their mirror images

    // The surface on which seams are decided. Numbers of faces.
    Index mirrored_faces = 6000; // with its mirror image; half as many again without
    Index large_model = 60000;   // gets the seams of a surface with half as many faces: trials of
                                 // large patches take long; a quarter is its own working surface
    double plane_snap = 0.35;    // of a vertex' shortest edge: moved onto the plane, no slivers
    double whole_area = 0.8;     // what both halves have at least together

    // The skeleton.
    std::size_t skeleton_memory = std::size_t{1} << 28; // bytes; only what is used gets memory
    Index skeleton_faces = 4000;     // needs no details; parts with a hundredth have none
    double bone_tolerance = 0.02;    // curves become bones within it
    double shortest_bone = 0.03;     // shorter curves are no bones
    std::size_t bones_at_vertex = 6; // the others add up to little
    double least_bone = 1e-3;        // of the heat at a vertex
    // Heat from a bone against heat along the surface: 1 in [BP07], where a stout body takes the
    // heat of its limbs.
    double conductance = 10.0;
    // Squared sine of the angle between bones and normal from which on bones have a direction on
    // the surface: about 20 degrees.
    double lying = 0.12;
    double kernel_shift = 1e-8;    // of the mean diagonal: constants are in the Laplacian's kernel
    double curvature_radius = 2.0; // mean edges: smoothing of the curvature

    // Where seams look natural.
    double beside_edge = 0.015; // how far normals and borders of limbs count
    double near_image = 0.02;   // nearer seams are mirror images; directions are over twice that
    double aligned = 30.0 * degrees; // with the skeleton; and the bend of a crease, a third of it
                                     // in concave places

    // Limbs.
    int limb_rings = 120;        // by distance from the tip
    double limb_reach = 0.75;    // of the model's extent: roots are not looked for beyond
    double largest_limb = 0.35;  // larger ones are bodies
    double limb_widening = 1.35; // of the ring behind a root over the ring before it
    double inner_band = 0.75;    // the cut lies within these shares of the root's distance
    double outer_band = 1.3;
    double concave_gain = 4.0; // how much cheaper an edge of curvature −1 is than a flat one
    double same_limb = 0.6;    // common area over the area of both together

    // Shares of costs that go where seams look natural.
    double least_path_weight = 1e-4; // so that paths stay short where a term vanishes
    double natural_seam = 0.95;      // of a seam's weight
    double natural_dart = 0.8;       // of a dart's length
    // Of a path along another surface's seam, where patches are judged by areas, and by strain.
    double natural_transfer = 0.4;
    double strained_transfer = 0.6;
    double natural_cut = 0.9;      // of a path's length, where patches are judged by strain
    double natural_straight = 0.5; // while seams are straightened
    double shared_seam = 0.25;     // factor of edges that are seams already

    double flat_region = 0.01;  // of the surface: nobody sews across a flat face as large as that
    double through_flat = 10.0; // factor of its edges

    // Local seams.
    double fragment = 4e-4;    // smaller parts go to a neighbour
    double least_split = 0.12; // of the patch: smaller parts are not cut off by isolines
    int patient_rounds = 15;   // after them, what is left is cut in halves
    int isoline_rounds = 4;    // of smoothing

    // Removal.
    std::size_t batch = 6;    // trials that run side by side; fixed, for the same result anywhere
    int most_passes = 2;      // over all segments
    double nearly_flat = 0.3; // of the bound: what large patches change their areas at most
    double small_patch = 0.1; // smaller ones are joined along narrow necks once seams are straight;
                              // a fifth of it on the model, and a tenth with darts
    double narrow_neck = 0.15; // of the root of the smaller patch
    int corridor_rings = 3;    // of vertices beside a segment: where it is made straight
    double path_worth = 0.97;  // of its cost: what a new path must save
    // What stays of a seam is an end, or two; the middle goes first. The widest windows come first.
    Window join_windows[15] = {{0.0, 1.0},  {0.15, 1.0},  {0.0, 0.85}, {0.15, 0.85}, {0.35, 1.0},
                               {0.0, 0.65}, {0.25, 0.75}, {0.55, 1.0}, {0.0, 0.45},  {0.35, 0.65},
                               {0.7, 1.0},  {0.0, 0.3},   {0.4, 0.6},  {0.2, 0.45},  {0.55, 0.8}};
    // A dart keeps its outer end, which comes first.
    Window dart_windows[4] = {{0.0, 1.0}, {0.3, 1.0}, {0.55, 1.0}, {0.8, 1.0}};

    // Transfer to the model.
    int fit_turns = 30;         // of moving the surface onto the model, each time less smoothly
    int curve_rounds = 3;       // of smoothing, before seams become edges of the model
    double strip_width = 2.5;   // mean edges of the first surface: paths leave the line no farther
    double leaning = 2.0;       // mean edges of the second one: a path so far away costs double
    double least_leaning = 0.1; // of that, where the second surface is no finer than the first
    std::size_t path_edges = 6; // of a segment: longer paths could take a short cut
    // Of the bound: what is used of it on another surface than the model, on the model before seams
    // are smoothed, by areas and by strain, and in each round of deciding again.
    double far_margin = 0.75;
    double far_strain = 0.65;
    double own_margin = 0.95;
    double own_strain = 0.9;
    double tighter = 0.88;
    int second_thoughts = 1;    // rounds of deciding again; one more where there are two halves
    int most_cuts = 4;          // that mend a patch
    double longest_darts = 1.5; // over the border of a remnant that goes: an island is worse

    // Thin tips. Shares of the root of the surface.
    double thin = 0.03;          // tongues that are narrower go
    double least_thin = 2.4;     // mean edges: at least so narrow
    double tongue_slack = 1.3;   // paths over faces are longer than straight lines
    double tongue_reach = 0.8;   // of half the width: how far a tongue sticks out at least
    double corner_reach = 0.033; // of seams beside a corner
    double acute = 40.0 * degrees;
    // Over the reach: how far along both seams a junction may slide.
    std::array<double, 9> slides{0.4, 0.7, 1.0, 1.5, 2.2, 3.2, 4.5, 6.5, 9.0};
};
constexpr Tuning tuning;

} // namespace devseg::plush
