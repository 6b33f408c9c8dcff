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

// Whether the pieces hang together by their seams.
bool hang_together(const PieceGraph& graph, const std::vector<Index>& pieces) {
    graph::Unions unions(graph.area.size());
    std::vector<std::uint8_t> is_one(graph.area.size(), 0);
    for (const Index a : pieces)
        is_one[at(a)] = 1;
    std::size_t parts = pieces.size();
    for (const Index a : pieces)
        for (const auto& [b, length] : graph.mm[at(a)])
            if (is_one[at(b)] != 0 && length > 0.0 && unions.find(a) != unions.find(b)) {
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
        seams_of_.resize(pattern.pieces.size());
        for (std::size_t s = 0; s < pattern.seams.size(); ++s)
            for (const pattern::SeamSide& side : pattern.seams[s].sides)
                if (std::vector<Index>& own = seams_of_[at(side.piece)];
                    own.empty() || own.back() != static_cast<Index>(s))
                    own.push_back(static_cast<Index>(s));
    }

    Assembly plan() {
        grouping_ = craft_ == Craft::sewing ? group_by_limbs(pattern_, graph_, progress_)
                                            : group_by_seams(graph_, progress_);
        progress_.check();
        if (craft_ == Craft::sewing)
            plan_.openings = find_openings(pattern_, graph_, progress_);
        for (const Opening& opening : plan_.openings)
            waits_[at(opening.seam)] = opening.is_whole ? 1 : 0;
        std::vector<Component> components = find_components();
        for (Component& component : components)
            choose_closing(component);
        for (Index p = 0; p < graph_.piece_count; ++p)
            add_darts(p);
        for (const Component& component : components)
            plan_component(component);
        for (AssemblyStep& step : plan_.steps)
            if (step.kind == StepKind::dart)
                step.section = plan_.section[at(step.pieces.front())];
        return std::move(plan_);
    }

private:
    // What hangs together.
    struct Component {
        Index number = 0; // in the graph
        std::vector<Index> pieces;
        // Of a closed solid to glue: its last piece, or the last seam where it is of one piece.
        Index lid = -1;
        Index last_seam = -1;
    };

    // Solids after what stays open: the last step of all closes one.
    std::vector<Component> find_components() const {
        std::vector<Component> components(at(graph_.component_count));
        for (std::size_t c = 0; c < components.size(); ++c)
            components[c].number = static_cast<Index>(c);
        for (Index p = 0; p < graph_.piece_count; ++p)
            components[at(graph_.component[at(p)])].pieces.push_back(p);
        std::stable_partition(components.begin(), components.end(), [&](const Component& c) {
            return graph_.is_closed[at(c.number)] == 0;
        });
        return components;
    }

    void choose_closing(Component& component) {
        progress_.check();
        if (craft_ != Craft::papercraft || graph_.is_closed[at(component.number)] == 0)
            return;
        component.lid = choose_lid(component.pieces);
        if (component.lid >= 0)
            return;
        component.last_seam = longest_seam(component.number);
        if (component.last_seam >= 0)
            waits_[at(component.last_seam)] = 1;
    }

    void add_step(StepKind kind, Index section, std::vector<Index> seams,
                  std::vector<Index> pieces) {
        plan_.steps.push_back({kind, section, std::move(seams), std::move(pieces)});
        for (const Index s : plan_.steps.back().seams)
            if (plan_.seam_step[at(s)] == 0)
                plan_.seam_step[at(s)] = static_cast<Index>(plan_.steps.size());
    }

    // Seams of the pieces that are still to be done, in their order.
    template <class Wanted>
    std::vector<Index> seams_where(const std::vector<Index>& pieces, Wanted wanted) const {
        std::vector<Index> seams;
        for (const Index p : pieces)
            for (const Index s : seams_of_[at(p)])
                if (plan_.seam_step[at(s)] == 0 && waits_[at(s)] == 0 &&
                    wanted(pattern_.seams[at(s)]))
                    seams.push_back(s);
        std::sort(seams.begin(), seams.end());
        seams.erase(std::unique(seams.begin(), seams.end()), seams.end());
        return seams;
    }
    std::vector<Index> seams_between(const std::vector<Index>& built,
                                     const std::vector<Index>& added) const {
        std::vector<std::uint8_t> side(seams_of_.size(), 0);
        for (const Index p : built)
            side[at(p)] = 1;
        for (const Index p : added)
            side[at(p)] = 2;
        return seams_where(added, [&](const pattern::Seam& seam) {
            return side[at(seam.sides[0].piece)] + side[at(seam.sides[1].piece)] == 3;
        });
    }
    // The piece's seams with itself.
    std::vector<Index> own_seams(Index piece) const {
        return seams_where({piece}, [](const pattern::Seam& seam) {
            return seam.sides[0].piece == seam.sides[1].piece;
        });
    }

    void add_darts(Index piece) {
        const std::vector<Index> darts = seams_where({piece}, [&](const pattern::Seam& seam) {
            return seam.is_dart && seam.sides[0].piece == piece;
        });
        if (!darts.empty())
            add_step(StepKind::dart, 0, darts, {piece});
    }

    // What is left to join to what is built, by the length that it shares with that.
    class Rest {
    public:
        Rest(const PieceGraph& graph, std::vector<std::vector<Index>> parts)
            : graph_(graph), parts_(std::move(parts)), shared_(parts_.size(), 0.0),
              part_of_(at(graph.piece_count), -1) {
            for (std::size_t i = 0; i < parts_.size(); ++i)
                for (const Index p : parts_[i])
                    part_of_[at(p)] = static_cast<Index>(i);
        }

        void build(const std::vector<Index>& pieces) {
            for (const Index p : pieces)
                for (const auto& [q, length] : graph_.mm[at(p)])
                    if (part_of_[at(q)] >= 0)
                        shared_[at(part_of_[at(q)])] += length;
        }
        // Takes out the one that shares the most with what is built; nothing where none shares any.
        std::vector<Index> take() {
            const auto most = std::max_element(shared_.begin(), shared_.end());
            if (most == shared_.end() || !(*most > 0.0))
                return {};
            *most = 0.0;
            std::vector<Index> part =
                std::move(parts_[static_cast<std::size_t>(most - shared_.begin())]);
            for (const Index p : part)
                part_of_[at(p)] = -1;
            return part;
        }
        // All that was not taken.
        std::vector<Index> left() const {
            std::vector<Index> pieces;
            for (const std::vector<Index>& part : parts_)
                pieces.insert(pieces.end(), part.begin(), part.end());
            return pieces;
        }

    private:
        const PieceGraph& graph_;
        std::vector<std::vector<Index>> parts_; // empty when taken
        std::vector<double> shared_;            // mm, of each part
        std::vector<Index> part_of_;            // of each piece, −1 = none
    };

    // The piece to begin with: the one with the longest seams to others of the section.
    static std::size_t first_of(const PieceGraph& graph, const std::vector<Index>& pieces) {
        std::size_t best = 0;
        double most = -1.0;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            double sum = 0.0;
            for (const Index q : pieces)
                sum += q == pieces[i] ? 0.0 : graph.shared(pieces[i], q);
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
        std::vector<std::vector<Index>> others;
        const std::size_t first = first_of(graph_, pieces);
        for (std::size_t i = 0; i < pieces.size(); ++i)
            if (i != first)
                others.push_back({pieces[i]});
        Rest rest(graph_, std::move(others));
        made = {pieces[first]};
        rest.build(made);
        for (std::vector<Index> added = rest.take(); !added.empty(); added = rest.take()) {
            const std::vector<Index> seams = seams_between(made, added);
            std::vector<Index> named = added;
            if (made.size() == 1)
                named.insert(named.begin(), made.front());
            if (!seams.empty()) // else the opening is all that joins it
                add_step(StepKind::join, section, seams, named);
            made.push_back(added.front());
            rest.build(added);
        }
        for (const Index p : made) {
            plan_.section[at(p)] = section;
            const std::vector<Index> own = own_seams(p);
            if (!own.empty())
                add_step(StepKind::tube, section, own, {p});
        }
        return rest.left();
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
            const auto seams = [&](Index q) { return seams_of_[at(q)].size(); };
            // Of those with room for a finger the one with the fewest seams.
            const bool fits = radius(p) >= tuning.finger;
            if (best < 0 || (fits != (radius(best) >= tuning.finger) ? fits
                             : fits                                  ? seams(p) < seams(best)
                                                                     : radius(p) > radius(best)))
                best = p;
        }
        return best;
    }

    void plan_component(const Component& component) {
        progress_.check();
        std::vector<Index> pieces = component.pieces;
        pieces.erase(std::remove(pieces.begin(), pieces.end(), component.lid), pieces.end());
        attach_all(make_sections(pieces));
        close(component, pieces);
    }

    // One that is no dart, if there is any.
    Index longest_seam(Index component) const {
        Index best = -1;
        const auto rank = [&](Index s) {
            const pattern::Seam& seam = pattern_.seams[at(s)];
            return std::pair(!seam.is_dart, seam.sides[0].length);
        };
        for (Index s = 0; s < static_cast<Index>(pattern_.seams.size()); ++s)
            if (graph_.component[at(pattern_.seams[at(s)].sides[0].piece)] == component &&
                (best < 0 || rank(s) > rank(best)))
                best = s;
        return best;
    }

    // All sections of a component: the body last, or else the largest.
    std::vector<std::vector<Index>> make_sections(const std::vector<Index>& pieces) {
        std::vector<std::vector<Index>> groups;
        std::vector<Index> labels;
        for (const Index p : pieces) {
            const Index label = grouping_.section[at(p)];
            const auto known = std::find(labels.begin(), labels.end(), label);
            if (known == labels.end()) {
                labels.push_back(label);
                groups.push_back({p});
            } else {
                groups[static_cast<std::size_t>(known - labels.begin())].push_back(p);
            }
        }
        const auto rank = [&](const std::vector<Index>& group) {
            double sum = 0.0;
            for (const Index p : group)
                sum += graph_.area[at(p)];
            return std::pair(grouping_.is_body[at(group.front())], sum);
        };
        std::stable_sort(groups.begin(), groups.end(),
                         [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
        std::vector<std::vector<Index>> sections;
        for (std::vector<Index> rest : groups)
            while (!rest.empty()) {
                std::vector<Index> made;
                rest = make_section(rest, made);
                sections.push_back(std::move(made));
            }
        return sections;
    }

    void attach_all(std::vector<std::vector<Index>> sections) {
        if (sections.empty())
            return;
        std::vector<Index> built = std::move(sections.back());
        sections.pop_back();
        Rest rest(graph_, std::move(sections));
        rest.build(built);
        for (std::vector<Index> added = rest.take(); !added.empty(); added = rest.take()) {
            const std::vector<Index> seams = seams_between(built, added);
            const Index section = plan_.section[at(added.front())];
            if (!seams.empty())
                add_step(StepKind::attach, section, seams, added);
            built.insert(built.end(), added.begin(), added.end());
            rest.build(added);
        }
    }

    void close(const Component& component, const std::vector<Index>& built) {
        if (const Index lid = component.lid; lid >= 0) {
            plan_.section[at(lid)] = plan_.section_count++;
            const std::vector<Index> own = own_seams(lid);
            if (!own.empty())
                add_step(StepKind::tube, plan_.section[at(lid)], own, {lid});
            add_step(StepKind::close, plan_.section[at(lid)], seams_between(built, {lid}), {lid});
        } else if (component.last_seam >= 0) {
            const Index piece = pattern_.seams[at(component.last_seam)].sides[0].piece;
            add_step(StepKind::close, plan_.section[at(piece)], {component.last_seam}, {});
        }
        for (const Opening& opening : plan_.openings) {
            const Index piece = pattern_.seams[at(opening.seam)].sides[0].piece;
            if (graph_.component[at(piece)] == component.number)
                add_step(StepKind::close, plan_.section[at(piece)], {opening.seam}, {});
        }
    }

    const pattern::Pattern& pattern_;
    Craft craft_;
    const Progress& progress_;
    PieceGraph graph_;
    Grouping grouping_;
    std::vector<std::vector<Index>> seams_of_; // of each piece, in their order
    std::vector<std::uint8_t> waits_;          // #seams: 1 until the last step
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
