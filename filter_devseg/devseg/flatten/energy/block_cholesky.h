// Cholesky factorization of sparse matrices of blocks, two by two: those of maps in the plane. One
// index for four numbers makes it several times as fast as that of single numbers.
//
// References
//   T. A. Davis: Algorithm 849: A Concise Sparse Cholesky Factorization Package. ACM Transactions
//   on Mathematical Software 31(4), 2005. doi:10.1145/1114268.1114277 (the up-looking
//   factorization)
#pragma once

#include <array>
#include <vector>

#include <Eigen/SparseCore>

#include "devseg/base/numbers.h"

namespace devseg::flatten {

class BlockCholesky {
public:
    /// Finds the order of elimination. `matrix` (2 n by 2 n) is the lower half of a symmetric one
    /// whose blocks are stored whole, but for the upper corners of those on the diagonal.
    void analyze(const Eigen::SparseMatrix<double>& matrix);

    /// Of a matrix with the same places. False where it is not positive definite.
    bool factorize(const Eigen::SparseMatrix<double>& matrix);

    Eigen::VectorXd solve(const Eigen::VectorXd& rhs) const;

private:
    using Block = std::array<double, 4>; // column by column

    struct Source {
        Index row;                    // of the block above the diagonal, after reordering
        std::ptrdiff_t first, second; // where its columns are in the matrix
        bool transposed;
    };

    void find_columns();
    void load(const Eigen::SparseMatrix<double>& matrix, Index column, Block& diagonal);
    // Rows of the factor's row `column`, in the order in which they are needed.
    Index reach(Index column);

    Index count_ = 0;
    std::vector<Index> order_;                            // #blocks: which one is eliminated
    std::vector<Index> source_begin_;                     // of each column
    std::vector<Source> sources_;                         // above the diagonal
    std::vector<std::array<std::ptrdiff_t, 2>> diagonal_; // of each column, in the matrix
    std::vector<Index> parent_;                           // of the elimination tree, −1 at roots
    std::vector<std::size_t> begin_;                      // of each column of the factor
    std::vector<Index> row_;                              // of its blocks below the diagonal
    std::vector<Block> lower_;
    std::vector<Block> inverse_; // of the blocks on the diagonal
    // While factorizing
    std::vector<Block> work_;
    std::vector<Index> flag_;
    std::vector<Index> stack_;
};

} // namespace devseg::flatten
