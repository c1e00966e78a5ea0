// Growth of the second moments of switching systems.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <random>
#include <unsupported/Eigen/KroneckerProduct>

#include "filter/learn/switching/regression.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Largest eigenvalue of the operator on second moments, written as one matrix with blocks T_ij (F_i (x) F_i).
double growth_by_kronecker(const std::vector<MatrixXd>& F, const MatrixXd& T) {
  const Index K = T.rows(), n = F.front().rows();
  MatrixXd moments(K * n * n, K * n * n);
  for (Index i = 0; i < K; ++i)
    for (Index j = 0; j < K; ++j)
      moments.block(j * n * n, i * n * n, n * n, n * n) = T(i, j) * Eigen::kroneckerProduct(F[i], F[i]).eval();
  return moments.eigenvalues().cwiseAbs().maxCoeff();
}

/// Of modes x[k+1] = F_j x[k].
double growth_of(const std::vector<MatrixXd>& F, const MatrixXd& T) {
  const Index n = F.front().rows(), K = T.rows();
  SwitchingRegression model{MatrixXd(n * n, K), std::vector<MatrixXd>(F.size(), MatrixXd::Identity(n, n)), T,
                            Eigen::VectorXd::Constant(K, 1.0 / static_cast<double>(K))};
  for (Index j = 0; j < K; ++j) model.theta.col(j) = (F[j] - MatrixXd::Identity(n, n)).transpose().reshaped();
  return mean_square_growth({n, 0, false}, model);
}

MatrixXd sticky(Index modes, double stay) { return TransitionMatrix::sticky(modes, stay).matrix(); }

/// A system with poles r e^(+-i w), as of an ARX(2) model.
MatrixXd oscillator(double r, double w) { return MatrixXd{{2.0 * r * std::cos(w), -r * r}, {1.0, 0.0}}; }

MatrixXd block_diagonal(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd F = MatrixXd::Zero(a.rows() + b.rows(), a.cols() + b.cols());
  F.topLeftCorner(a.rows(), a.cols()) = a;
  F.bottomRightCorner(b.rows(), b.cols()) = b;
  return F;
}

// Independent draws of the mode: sum p_j f_j^2. The moments of equal oscillators rotate in phase, so a power iteration
// never converges.
TEST(MeanSquareGrowth, OfScalarModesAndOscillatorsIsTheClosedForm) {
  const MatrixXd half{{0.5}}, growing{{1.2}};
  EXPECT_NEAR(growth_of({half, growing}, MatrixXd{{0.7, 0.3}, {0.7, 0.3}}), 0.7 * 0.25 + 0.3 * 1.44, 1e-12);
  EXPECT_GT(growth_of({half, growing}, MatrixXd{{0.5, 0.5}, {0.01, 0.99}}), 1.0);
  EXPECT_NEAR(growth_of({oscillator(0.995, 0.5)}, sticky(1, 1.0)), 0.995 * 0.995, 1e-12);
  EXPECT_NEAR(growth_of({oscillator(0.9, 0.5), oscillator(0.9, 0.5)}, sticky(2, 0.97)), 0.81, 1e-12);
  EXPECT_TRUE(std::isinf(growth_of({MatrixXd::Constant(2, 2, not_a_number), MatrixXd::Zero(2, 2)}, sticky(2, 0.9))));
}

/// Small operators are solved densely, large ones by Arnoldi's iteration.
TEST(MeanSquareGrowth, OfRandomSystemsIsTheDenseEigenvalue) {
  std::mt19937_64 generator(5);
  boost::random::normal_distribution<double> normal;
  boost::random::uniform_real_distribution<double> uniform;
  int iterated = 0;
  for (int system = 0; system < 50; ++system) {
    const Index K = 1 + system % 4, n = 2 + 2 * (system / 4 % 4);
    std::vector<MatrixXd> F;
    for (Index j = 0; j < K; ++j) {
      MatrixXd one = MatrixXd::NullaryExpr(n, n, [&] { return normal(generator) / std::sqrt(static_cast<double>(n)); });
      if (system % 2 == 0)  // lightly damped oscillators in transformed coordinates
        for (one = oscillator(0.9 + 0.1 * uniform(generator), 3.0 * uniform(generator)); one.rows() < n;)
          one = block_diagonal(one, oscillator(0.9 + 0.1 * uniform(generator), 3.0 * uniform(generator)));
      F.push_back(one);
    }
    const MatrixXd T = sticky(K, 0.3 + 0.699 * uniform(generator));
    const double by_kronecker = growth_by_kronecker(F, T);
    EXPECT_NEAR(growth_of(F, T), by_kronecker, 1e-8 * by_kronecker) << system;
    iterated += K > 1 && K * n * (n + 1) / 2 > 64 ? 1 : 0;
  }
  EXPECT_GE(iterated, 12);
}

// Defective operators: chains of integrators, and coinciding poles. The closed form is the squared spectral radius.
TEST(MeanSquareGrowth, OfDefectiveSystemsIsTheSquaredRadius) {
  const MatrixXd twice{{1.0, 0.1}, {0.0, 1.0}}, thrice{{1.0, 0.1, 0.005}, {0.0, 1.0, 0.1}, {0.0, 0.0, 1.0}};
  const MatrixXd critical = oscillator(0.9, 0.0), growing = 1.002 * twice;
  for (const Index K : {1, 2, 5})
    for (const auto& [F, radius] : {std::pair{twice, 1.0}, {thrice, 1.0}, {critical, 0.9}, {growing, 1.002}}) {
      const double growth = growth_of(std::vector<MatrixXd>(K, F), sticky(K, 0.95));
      EXPECT_NEAR(growth, radius * radius, 1e-3) << K << '\n' << F;
      EXPECT_EQ(growth > 1.0 + growth_slack, radius > 1.0) << "on the safe side of the threshold";
    }
  // A system of triangular modes grows like their diagonals.
  EXPECT_NEAR(growth_of({twice, MatrixXd{{1.0, 0.3}, {0.0, 1.0}}}, sticky(2, 0.9)), 1.0, 1e-4);
}

}  // namespace
}  // namespace modebank
