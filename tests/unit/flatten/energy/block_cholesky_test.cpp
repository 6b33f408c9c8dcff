#include "devseg/flatten/energy/block_cholesky.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "unit/mesh_edits.h"

namespace devseg::flatten {
namespace {

// A positive definite matrix of blocks at random places, its lower half.
Eigen::SparseMatrix<double> blocks(Index count, int seed) {
    shapes::Random random(static_cast<std::uint32_t>(seed));
    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(2 * count, 2 * count);
    std::vector<Eigen::Triplet<double>> entries;
    const auto put = [&](Index v, Index u) {
        for (Index r = 0; r < 2; ++r)
            for (Index s = 0; s < 2; ++s)
                if (2 * v + r >= 2 * u + s)
                    entries.emplace_back(2 * v + r, 2 * u + s,
                                         random.uniform(-1.0, 1.0) +
                                             (v == u && r == s ? 20.0 : 0.0));
    };
    for (Index u = 0; u < count; ++u) {
        put(u, u);
        for (Index v = u + 1; v < count; ++v)
            if (random.uniform(0.0, 1.0) < 0.1)
                put(v, u);
    }
    Eigen::SparseMatrix<double> matrix(2 * count, 2 * count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
}

TEST(BlockCholesky, SolvesWhatADenseSolverDoes) {
    for (const Index count : {1, 2, 17, 80}) {
        BlockCholesky solver;
        for (const int seed : {3, 4}) { // the second matrix has other values
            Eigen::SparseMatrix<double> matrix = blocks(count, 3);
            matrix *= static_cast<double>(seed);
            if (seed == 3)
                solver.analyze(matrix);
            ASSERT_TRUE(solver.factorize(matrix));
            const Eigen::MatrixXd dense = Eigen::MatrixXd(matrix).selfadjointView<Eigen::Lower>();
            const Eigen::VectorXd rhs = Eigen::VectorXd::LinSpaced(2 * count, -1.0, 2.0);
            EXPECT_LT((dense * solver.solve(rhs) - rhs).norm(), 1e-10 * rhs.norm());
        }
    }
}

TEST(BlockCholesky, RefusesIndefiniteMatrices) {
    Eigen::SparseMatrix<double> matrix = blocks(20, 5);
    BlockCholesky solver;
    solver.analyze(matrix);
    matrix.coeffRef(17, 17) = -1.0;
    EXPECT_FALSE(solver.factorize(matrix));
    matrix.coeffRef(17, 17) = 20.0;
    EXPECT_TRUE(solver.factorize(matrix)); // and goes on
}

} // namespace
} // namespace devseg::flatten
