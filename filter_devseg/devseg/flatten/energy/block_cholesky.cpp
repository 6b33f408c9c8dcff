#include "devseg/flatten/energy/block_cholesky.h"

#include <algorithm>

#include <Eigen/OrderingMethods>

namespace devseg::flatten {

namespace {

using Block = std::array<double, 4>;

Block product(const Block& a, const Block& b) {
    return {a[0] * b[0] + a[2] * b[1], a[1] * b[0] + a[3] * b[1], a[0] * b[2] + a[2] * b[3],
            a[1] * b[2] + a[3] * b[3]};
}

void subtract(const Block& b, Block& from) {
    for (std::size_t i = 0; i < b.size(); ++i)
        from[i] -= b[i];
}

} // namespace

void BlockCholesky::analyze(const Eigen::SparseMatrix<double>& matrix) {
    const int* const outer = matrix.outerIndexPtr();
    const int* const inner = matrix.innerIndexPtr();
    count_ = static_cast<Index>(matrix.cols() / 2);
    std::vector<Eigen::Triplet<double>> entries;
    for (Index u = 0; u < count_; ++u) {
        entries.emplace_back(u, u, 1.0);
        for (int p = outer[2 * u] + 2; p < outer[2 * u + 1]; p += 2) {
            entries.emplace_back(inner[p] / 2, u, 1.0);
            entries.emplace_back(u, inner[p] / 2, 1.0);
        }
    }
    Eigen::SparseMatrix<double> pattern(count_, count_);
    pattern.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> inverse;
    Eigen::AMDOrdering<int>()(pattern, inverse);
    order_.assign(inverse.indices().data(), inverse.indices().data() + count_);
    std::vector<Index> place(at(count_));
    for (Index k = 0; k < count_; ++k)
        place[at(order_[at(k)])] = k;

    source_begin_.assign(at(count_) + 1, 0);
    diagonal_.resize(at(count_));
    const auto visit = [&](auto put) {
        for (Index u = 0; u < count_; ++u)
            for (int p = outer[2 * u] + 2, q = outer[2 * u + 1] + 1; p < outer[2 * u + 1];
                 p += 2, q += 2) {
                const Index i = place[at(inner[p] / 2)];
                const Index j = place[at(u)];
                put(std::max(i, j), Source{std::min(i, j), p, q, i > j});
            }
    };
    visit([&](Index column, const Source&) { ++source_begin_[at(column) + 1]; });
    for (std::size_t k = 0; k < at(count_); ++k)
        source_begin_[k + 1] += source_begin_[k];
    sources_.resize(at(source_begin_.back()));
    std::vector<Index> next(source_begin_.begin(), source_begin_.end() - 1);
    visit([&](Index column, const Source& source) { sources_[at(next[at(column)]++)] = source; });
    for (Index u = 0; u < count_; ++u)
        diagonal_[at(place[at(u)])] = {outer[2 * u], outer[2 * u + 1]};
    find_columns();
}

// The elimination tree, and how many blocks each column of the factor has.
void BlockCholesky::find_columns() {
    parent_.assign(at(count_), -1);
    flag_.assign(at(count_), -1);
    stack_.resize(at(count_));
    work_.assign(at(count_), Block{});
    std::vector<std::size_t> size(at(count_), 0);
    for (Index k = 0; k < count_; ++k) {
        flag_[at(k)] = k;
        for (Index s = source_begin_[at(k)]; s < source_begin_[at(k) + 1]; ++s)
            for (Index i = sources_[at(s)].row; flag_[at(i)] != k; i = parent_[at(i)]) {
                if (parent_[at(i)] < 0)
                    parent_[at(i)] = k;
                ++size[at(i)];
                flag_[at(i)] = k;
            }
    }
    begin_.assign(at(count_) + 1, 0);
    for (std::size_t k = 0; k < size.size(); ++k)
        begin_[k + 1] = begin_[k] + size[k];
    row_.resize(begin_.back());
    lower_.resize(begin_.back());
    inverse_.resize(at(count_));
}

void BlockCholesky::load(const Eigen::SparseMatrix<double>& matrix, Index column, Block& diagonal) {
    const double* const value = matrix.valuePtr();
    for (Index s = source_begin_[at(column)]; s < source_begin_[at(column) + 1]; ++s) {
        const Source& source = sources_[at(s)];
        const double a = value[source.first];
        const double b = value[source.first + 1];
        const double c = value[source.second];
        const double d = value[source.second + 1];
        work_[at(source.row)] = source.transposed ? Block{a, c, b, d} : Block{a, b, c, d};
    }
    const auto [first, second] = diagonal_[at(column)];
    diagonal = {value[first], value[first + 1], value[first + 1], value[second]};
}

Index BlockCholesky::reach(Index column) {
    Index top = count_;
    flag_[at(column)] = column;
    for (Index s = source_begin_[at(column)]; s < source_begin_[at(column) + 1]; ++s) {
        Index length = 0;
        for (Index i = sources_[at(s)].row; flag_[at(i)] != column; i = parent_[at(i)]) {
            stack_[at(length++)] = i;
            flag_[at(i)] = column;
        }
        while (length > 0)
            stack_[at(--top)] = stack_[at(--length)];
    }
    return top;
}

bool BlockCholesky::factorize(const Eigen::SparseMatrix<double>& matrix) {
    std::vector<std::size_t> end(begin_.begin(), begin_.end() - 1);
    std::fill(flag_.begin(), flag_.end(), -1);
    for (Index k = 0; k < count_; ++k) {
        Block diagonal;
        load(matrix, k, diagonal);
        for (Index t = reach(k); t < count_; ++t) {
            const Index i = stack_[at(t)];
            const Block y = work_[at(i)];
            work_[at(i)] = Block{};
            std::size_t& last = end[at(i)];
            for (std::size_t p = begin_[at(i)]; p < last; ++p)
                subtract(product(lower_[p], y), work_[at(row_[p])]);
            const Block solved = product(inverse_[at(i)], y);
            lower_[last] = {solved[0], solved[2], solved[1], solved[3]};
            subtract(product(lower_[last], y), diagonal);
            row_[last++] = k;
        }
        const double off = 0.5 * (diagonal[1] + diagonal[2]);
        const double determinant = diagonal[0] * diagonal[3] - off * off;
        if (!(diagonal[0] > 0.0) || !(determinant > 0.0)) {
            std::fill(work_.begin(), work_.end(), Block{});
            return false;
        }
        inverse_[at(k)] = {diagonal[3] / determinant, -off / determinant, -off / determinant,
                           diagonal[0] / determinant};
    }
    return true;
}

Eigen::VectorXd BlockCholesky::solve(const Eigen::VectorXd& rhs) const {
    std::vector<std::array<double, 2>> x(at(count_));
    for (std::size_t k = 0; k < x.size(); ++k)
        x[k] = {rhs[2 * order_[k]], rhs[2 * order_[k] + 1]};
    for (std::size_t k = 0; k < x.size(); ++k)
        for (std::size_t p = begin_[k]; p < begin_[k + 1]; ++p) {
            const Block& l = lower_[p];
            auto& to = x[at(row_[p])];
            to[0] -= l[0] * x[k][0] + l[2] * x[k][1];
            to[1] -= l[1] * x[k][0] + l[3] * x[k][1];
        }
    for (std::size_t k = x.size(); k-- > 0;) {
        const Block& d = inverse_[k];
        std::array<double, 2> sum{d[0] * x[k][0] + d[2] * x[k][1], d[1] * x[k][0] + d[3] * x[k][1]};
        for (std::size_t p = begin_[k]; p < begin_[k + 1]; ++p) {
            const Block& l = lower_[p];
            const auto& from = x[at(row_[p])];
            sum[0] -= l[0] * from[0] + l[1] * from[1];
            sum[1] -= l[2] * from[0] + l[3] * from[1];
        }
        x[k] = sum;
    }
    Eigen::VectorXd solution(rhs.size());
    for (std::size_t k = 0; k < x.size(); ++k) {
        solution[2 * order_[k]] = x[k][0];
        solution[2 * order_[k] + 1] = x[k][1];
    }
    return solution;
}

} // namespace devseg::flatten
