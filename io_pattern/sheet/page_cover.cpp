#include "sheet/page_cover.h"

#include <algorithm>

namespace devseg::sheet {

namespace {

class Cover {
public:
    Cover(Index columns, Index rows, const std::vector<Index>& amounts)
        : columns_(columns), across_(parts_of(columns)), amounts_(amounts),
          owner_(amounts.size(), -1), is_printed_(at(columns * rows), 0) {}

    std::vector<Index> find() {
        for (Index part = 0; part < count(); ++part)
            if (amounts_[at(part)] > 0 && part % across_ % 2 == 0 && part / across_ % 2 == 0)
                print(pages_of(part).front());
        while (true) {
            std::vector<Index> votes(is_printed_.size(), 0);
            for (Index part = 0; part < count(); ++part)
                vote(part, votes);
            const auto most = std::max_element(votes.begin(), votes.end());
            if (most == votes.end() || *most == 0)
                return std::move(owner_);
            print(static_cast<Index>(most - votes.begin()));
        }
    }

private:
    Index count() const { return static_cast<Index>(amounts_.size()); }
    void print(Index page) { is_printed_[at(page)] = 1; }

    std::array<Index, 4> pages_of(Index part) const {
        const auto x = pages_of_part(part % across_);
        const auto y = pages_of_part(part / across_);
        return {y[0] * columns_ + x[0], y[0] * columns_ + x[1], y[1] * columns_ + x[0],
                y[1] * columns_ + x[1]};
    }

    // For a page of the part, unless one of them is printed.
    void vote(Index part, std::vector<Index>& votes) {
        if (amounts_[at(part)] == 0 || owner_[at(part)] >= 0)
            return;
        const std::array<Index, 4> pages = pages_of(part);
        const auto printed = std::find_if(pages.begin(), pages.end(),
                                          [&](Index page) { return is_printed_[at(page)] != 0; });
        if (printed != pages.end()) {
            owner_[at(part)] = *printed;
            return;
        }
        for (std::size_t i = 0; i < pages.size(); ++i)
            if (std::find(pages.begin(), pages.begin() + i, pages[i]) == pages.begin() + i)
                ++votes[at(pages[i])];
    }

    Index columns_;
    Index across_; // parts
    const std::vector<Index>& amounts_;
    std::vector<Index> owner_;
    std::vector<std::uint8_t> is_printed_;
};

} // namespace

std::vector<Index> cover_parts(Index columns, Index rows, const std::vector<Index>& amounts) {
    return Cover(columns, rows, amounts).find();
}

} // namespace devseg::sheet
