#include "devseg/assembly/assembly.h"

#include <algorithm>

#include "devseg/assembly/opening.h"
#include "devseg/assembly/sections.h"
#include "devseg/graph/unions.h"

namespace devseg::assembly {

namespace {

struct Tuning {
    double finger = 8.0; // mm: radius of a circle inside the last piece, for a finger behind it
};
constexpr Tuning tuning;

bool joins(const pattern::Seam& seam, Index a, Index b) {
    const Index p = seam.sides[0].piece;
    const Index q = seam.sides[1].piece;
    return (p == a && q == b) || (p == b && q == a);
}

// Whether the pieces hang together by their seams.
bool hang_together(const PieceGraph& graph, const std::vector<Index>& pieces) {
    graph::Unions unions(graph.area.size());
    std::size_t parts = pieces.size();
    for (const Index a : pieces)
        for (const Index b : pieces)
            if (graph.mm[at(a)][at(b)] > 0.0 && unions.find(a) != unions.find(b)) {
                unions.join(unions.find(a), unions.find(b));
                --parts;
            }
    return parts <= 1;
}

class Planner {
public:
    Planner(const pattern::Pattern& pattern, Craft craft, const Progress& progress)
        : pattern_(pattern), craft_(craft), progress_(progress), graph_(pattern) {
        plan_.seam_step.assign(pattern.seams.size(), 0);
        plan_.section.assign(pattern.pieces.size(), -1);
        waits_.assign(pattern.seams.size(), 0);
    }

    Assembly plan() {
        raw_section_ = find_sections(graph_);
        progress_.check();
        if (craft_ == Craft::sewing)
            plan_.openings = find_openings(pattern_, graph_, progress_);
        for (const Opening& opening : plan_.openings)
            waits_[at(opening.seam)] = opening.is_whole ? 1 : 0;
        for (Index p = 0; p < graph_.piece_count; ++p)
            add_darts(p);
        for (Index c = 0; c < graph_.component_count; ++c)
            plan_component(c);
        for (AssemblyStep& step : plan_.steps)
            if (step.kind == StepKind::dart)
                step.section = plan_.section[at(step.pieces.front())];
        return std::move(plan_);
    }

private:
    void add_step(StepKind kind, Index section, std::vector<Index> seams,
                  std::vector<Index> pieces) {
        plan_.steps.push_back({kind, section, std::move(seams), std::move(pieces)});
        for (const Index s : plan_.steps.back().seams)
            if (plan_.seam_step[at(s)] == 0)
                plan_.seam_step[at(s)] = static_cast<Index>(plan_.steps.size());
    }

    template <class Wanted>
    std::vector<Index> seams_where(Wanted wanted) const {
        std::vector<Index> seams;
        for (std::size_t s = 0; s < pattern_.seams.size(); ++s)
            if (plan_.seam_step[s] == 0 && waits_[s] == 0 && wanted(pattern_.seams[s]))
                seams.push_back(static_cast<Index>(s));
        return seams;
    }
    std::vector<Index> seams_between(const std::vector<Index>& built,
                                     const std::vector<Index>& added) const {
        return seams_where([&](const pattern::Seam& seam) {
            return std::any_of(built.begin(), built.end(), [&](Index a) {
                return std::any_of(added.begin(), added.end(),
                                   [&](Index b) { return joins(seam, a, b); });
            });
        });
    }
    double shared(const std::vector<Index>& a, const std::vector<Index>& b) const {
        double sum = 0.0;
        for (const Index p : a)
            for (const Index q : b)
                sum += graph_.mm[at(p)][at(q)];
        return sum;
    }

    void add_darts(Index piece) {
        const std::vector<Index> darts = seams_where([&](const pattern::Seam& seam) {
            return seam.is_dart && seam.sides[0].piece == piece;
        });
        if (!darts.empty())
            add_step(StepKind::dart, 0, darts, {piece});
    }

    // Joins the one of `rest` that shares the most with what is built; −1 where none shares any.
    template <class Parts>
    Index nearest(const std::vector<Index>& built, const Parts& rest) const {
        Index best = -1;
        double most = 0.0;
        for (std::size_t i = 0; i < rest.size(); ++i) {
            const double length = shared(built, rest[i]);
            if (length > most) {
                most = length;
                best = static_cast<Index>(i);
            }
        }
        return best;
    }

    // The piece to begin with: the one with the longest seams to others of the section.
    static std::size_t first_of(const PieceGraph& graph, const std::vector<Index>& pieces) {
        std::size_t best = 0;
        double most = -1.0;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            double sum = 0.0;
            for (const Index q : pieces)
                sum += q == pieces[i] ? 0.0 : graph.mm[at(pieces[i])][at(q)];
            if (sum > most) {
                most = sum;
                best = i;
            }
        }
        return best;
    }

    // Makes one section that hangs together; returns what of the pieces does not.
    std::vector<Index> make_section(const std::vector<Index>& pieces, std::vector<Index>& made) {
        const Index section = plan_.section_count++;
        std::vector<std::vector<Index>> rest;
        const std::size_t first = first_of(graph_, pieces);
        for (std::size_t i = 0; i < pieces.size(); ++i)
            if (i != first)
                rest.push_back({pieces[i]});
        made = {pieces[first]};
        for (Index next = nearest(made, rest); next >= 0; next = nearest(made, rest)) {
            const std::vector<Index> added = rest[at(next)];
            const std::vector<Index> seams = seams_between(made, added);
            std::vector<Index> named = added;
            if (made.size() == 1)
                named.insert(named.begin(), made.front());
            if (!seams.empty()) // else the opening is all that joins it
                add_step(StepKind::join, section, seams, named);
            made.push_back(added.front());
            rest.erase(rest.begin() + next);
        }
        for (const Index p : made) {
            plan_.section[at(p)] = section;
            const std::vector<Index> own =
                seams_where([&](const pattern::Seam& seam) { return joins(seam, p, p); });
            if (!own.empty())
                add_step(StepKind::tube, section, own, {p});
        }
        std::vector<Index> left;
        for (const std::vector<Index>& piece : rest)
            left.push_back(piece.front());
        return left;
    }

    // The last piece of a closed solid to glue; −1 where there is none.
    Index choose_lid(const std::vector<Index>& pieces) const {
        Index best = -1;
        for (const Index p : pieces) {
            std::vector<Index> rest = pieces;
            rest.erase(std::find(rest.begin(), rest.end(), p));
            if (rest.empty() || !hang_together(graph_, rest))
                continue;
            const auto radius = [&](Index q) { return pattern_.pieces[at(q)].label_radius; };
            const auto seams = [&](Index q) {
                return std::count_if(
                    pattern_.seams.begin(), pattern_.seams.end(), [&](const pattern::Seam& seam) {
                        return seam.sides[0].piece == q || seam.sides[1].piece == q;
                    });
            };
            // Of those with room for a finger the one with the fewest seams.
            const bool fits = radius(p) >= tuning.finger;
            if (best < 0 || (fits != (radius(best) >= tuning.finger) ? fits
                             : fits                                  ? seams(p) < seams(best)
                                                                     : radius(p) > radius(best)))
                best = p;
        }
        return best;
    }

    void plan_component(Index component) {
        progress_.check();
        std::vector<Index> pieces;
        for (Index p = 0; p < graph_.piece_count; ++p)
            if (graph_.component[at(p)] == component)
                pieces.push_back(p);
        const bool is_glued_shut = craft_ == Craft::papercraft && graph_.is_closed[at(component)];
        const Index lid = is_glued_shut ? choose_lid(pieces) : -1;
        const Index last_seam = is_glued_shut && lid < 0 ? longest_seam(pieces) : -1;
        if (last_seam >= 0)
            waits_[at(last_seam)] = 1;
        pieces.erase(std::remove(pieces.begin(), pieces.end(), lid), pieces.end());
        std::vector<std::vector<Index>> sections = make_sections(pieces);
        attach_all(sections);
        close(component, lid, last_seam, pieces);
    }

    Index longest_seam(const std::vector<Index>& pieces) const {
        Index best = -1;
        for (std::size_t s = 0; s < pattern_.seams.size(); ++s) {
            const pattern::Seam& seam = pattern_.seams[s];
            if (std::count(pieces.begin(), pieces.end(), seam.sides[0].piece) > 0 &&
                plan_.seam_step[s] == 0 &&
                (best < 0 || seam.sides[0].length > pattern_.seams[at(best)].sides[0].length))
                best = static_cast<Index>(s);
        }
        return best;
    }

    // All sections of a component, the largest last.
    std::vector<std::vector<Index>> make_sections(const std::vector<Index>& pieces) {
        std::vector<std::vector<Index>> groups;
        std::vector<Index> labels;
        for (const Index p : pieces) {
            const Index label = raw_section_[at(p)];
            const auto known = std::find(labels.begin(), labels.end(), label);
            if (known == labels.end()) {
                labels.push_back(label);
                groups.push_back({p});
            } else {
                groups[static_cast<std::size_t>(known - labels.begin())].push_back(p);
            }
        }
        const auto area = [&](const std::vector<Index>& group) {
            double sum = 0.0;
            for (const Index p : group)
                sum += graph_.area[at(p)];
            return sum;
        };
        std::stable_sort(groups.begin(), groups.end(),
                         [&](const auto& a, const auto& b) { return area(a) < area(b); });
        std::vector<std::vector<Index>> sections;
        for (std::vector<Index> rest : groups)
            while (!rest.empty()) {
                std::vector<Index> made;
                rest = make_section(rest, made);
                sections.push_back(std::move(made));
            }
        return sections;
    }

    void attach_all(std::vector<std::vector<Index>>& sections) {
        if (sections.empty())
            return;
        std::vector<Index> built = std::move(sections.back());
        sections.pop_back();
        for (Index next = nearest(built, sections); next >= 0; next = nearest(built, sections)) {
            const std::vector<Index> added = sections[at(next)];
            const std::vector<Index> seams = seams_between(built, added);
            const Index section = plan_.section[at(added.front())];
            if (!seams.empty())
                add_step(StepKind::attach, section, seams, added);
            built.insert(built.end(), added.begin(), added.end());
            sections.erase(sections.begin() + next);
        }
    }

    void close(Index component, Index lid, Index last_seam, const std::vector<Index>& built) {
        if (lid >= 0) {
            plan_.section[at(lid)] = plan_.section_count++;
            const std::vector<Index> own =
                seams_where([&](const pattern::Seam& seam) { return joins(seam, lid, lid); });
            if (!own.empty())
                add_step(StepKind::tube, plan_.section[at(lid)], own, {lid});
            add_step(StepKind::close, plan_.section[at(lid)], seams_between(built, {lid}), {lid});
        } else if (last_seam >= 0) {
            const Index piece = pattern_.seams[at(last_seam)].sides[0].piece;
            add_step(StepKind::close, plan_.section[at(piece)], {last_seam}, {});
        }
        for (const Opening& opening : plan_.openings) {
            const Index piece = pattern_.seams[at(opening.seam)].sides[0].piece;
            if (graph_.component[at(piece)] == component)
                add_step(StepKind::close, plan_.section[at(piece)], {opening.seam}, {});
        }
    }

    const pattern::Pattern& pattern_;
    Craft craft_;
    const Progress& progress_;
    PieceGraph graph_;
    std::vector<Index> raw_section_;
    std::vector<std::uint8_t> waits_; // #seams: 1 until the last step
    Assembly plan_;
};

} // namespace

Assembly plan_assembly(const pattern::Pattern& pattern, Craft craft, const Progress& progress) {
    return Planner(pattern, craft, progress).plan();
}

std::string section_name(Index section) {
    std::string name;
    for (Index rest = section + 1; rest > 0; rest = (rest - 1) / 26)
        name.insert(name.begin(), static_cast<char>('A' + (rest - 1) % 26));
    return name;
}

} // namespace devseg::assembly
