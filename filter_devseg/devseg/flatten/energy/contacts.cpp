#include "devseg/flatten/energy/contacts.h"

#include "devseg/plane/plane.h"

namespace devseg::flatten {

namespace {

// The distance of a vertex to the left of the line of its edge, with its derivatives.
struct SignedDistance {
    double value = 0.0;
    Vec2 by_vertex, by_from, by_to;
};

SignedDistance signed_distance(const Contact& contact, const Positions& x) {
    const Vec2 p = x.row(contact.vertex).transpose();
    const Vec2 a = x.row(contact.from).transpose();
    const Vec2 b = x.row(contact.to).transpose();
    const Vec2 direction = (b - a).normalized();
    const Vec2 left = plane::left_of(direction);
    const double length = (b - a).norm();
    const double along = (p - a).dot(direction) / length; // 0 at `from`, 1 at `to`
    SignedDistance d;
    d.value = (p - a).dot(left);
    // A motion of the edge's ends moves the foot of the vertex in proportion.
    d.by_vertex = left;
    d.by_from = -(1.0 - along) * left;
    d.by_to = -along * left;
    return d;
}

} // namespace

double ContactPenalty::energy(const Positions& x) const {
    double sum = 0.0;
    for (const Contact& contact : contacts) {
        const double depth = signed_distance(contact, x).value + gap;
        if (depth > 0.0)
            sum += depth * depth;
    }
    return 0.5 * stiffness * sum;
}

void ContactPenalty::add_gradient(const Positions& x, Positions& gradient) const {
    for (const Contact& contact : contacts) {
        const SignedDistance d = signed_distance(contact, x);
        const double force = stiffness * (d.value + gap);
        if (force <= 0.0)
            continue;
        gradient.row(contact.vertex) += force * d.by_vertex.transpose();
        gradient.row(contact.from) += force * d.by_from.transpose();
        gradient.row(contact.to) += force * d.by_to.transpose();
    }
}

// Of the three vertices of n · Σ cᵢ xᵢ, with Σ |cᵢ| = 2: a block of 2 |cᵢ| n nᵀ for each is above
// the whole.
void ContactPenalty::add_diagonal(const Positions& x, std::vector<Eigen::Matrix2d>& block) const {
    for (const Contact& contact : contacts) {
        const SignedDistance d = signed_distance(contact, x);
        if (d.value + gap <= 0.0)
            continue;
        for (const auto& [vertex, slope] :
             {std::pair(contact.vertex, d.by_vertex), std::pair(contact.from, d.by_from),
              std::pair(contact.to, d.by_to)})
            if (const double size = slope.norm(); size > 0.0)
                block[vertex] += 2.0 * stiffness / size * slope * slope.transpose();
    }
}

} // namespace devseg::flatten
