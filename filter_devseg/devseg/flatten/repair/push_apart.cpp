#include "devseg/flatten/repair/push_apart.h"

#include <algorithm>
#include <cmath>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/contacts.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/symmetric_dirichlet.h"
#include "devseg/flatten/repair/overlaps.h"

namespace devseg::flatten {

namespace {

// Pushing apart: rounds, each stiffer than the one before.
constexpr int push_rounds = 10;
constexpr double first_stiffness = 100.0; // in units of the energy per chart area
constexpr double stiffer = 2.0;
// Shape that pushing apart may cost, as growth of the symmetric Dirichlet energy: beyond it, a cut
// keeps the pattern truer than a deformation.
constexpr double push_cost = 0.01;

// Contacts of earlier rounds stay, because parts that were pushed apart must not come back, except
// where a vertex has new ones.
std::vector<Contact> merge_contacts(const std::vector<Contact>& old,
                                    std::vector<Contact> contacts) {
    const std::size_t found = contacts.size();
    for (const Contact& contact : old)
        if (std::none_of(contacts.begin(), contacts.begin() + static_cast<std::ptrdiff_t>(found),
                         [&](const Contact& c) { return c.vertex == contact.vertex; }))
            contacts.push_back(contact);
    return contacts;
}

} // namespace

std::optional<std::vector<Vec2>>
push_apart(const FlatteningProblem& problem, const atlas::ChartSurface& surface,
           std::vector<Vec2> uv, std::vector<std::pair<Index, Index>> pairs, double tolerance,
           const Progress& progress, double gap_share) {
    const double before = symmetric_dirichlet_energy(problem, uv);
    ContactPenalty penalty;
    penalty.stiffness = first_stiffness / problem.total_area;
    penalty.gap = gap_share * std::sqrt(problem.total_area);
    SymmetricDirichletOptions options;
    options.max_iterations = 30;
    for (int round = 0; round < push_rounds; ++round) {
        penalty.contacts = merge_contacts(penalty.contacts, find_contacts(surface, uv, pairs));
        try {
            uv = minimise_symmetric_dirichlet(problem, uv, options, progress, penalty).uv;
        } catch (const NumericalFailure&) { // needles: a cut is left
            return std::nullopt;
        }
        scale_to_area(problem, uv);
        if (symmetric_dirichlet_energy(problem, uv) > before + push_cost)
            return std::nullopt;
        pairs = overlapping_pairs(surface, uv, tolerance);
        if (pairs.empty())
            return uv;
        penalty.stiffness *= stiffer;
    }
    return std::nullopt;
}

} // namespace devseg::flatten
