// Growth of the second moments of switching systems.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <random>
#include <unsupported/Eigen/KroneckerProduct>

#include "filter/learn/switching/screening.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Largest eigenvalue of the operator on second moments, written as one matrix with blocks T_ij (F_i (x) F_i).
double growth_by_kronecker(const LinearStructure& structure, const SwitchingRegression& model) {
  const Index K = model.modes(), n = structure.dimension();
  Eigen::MatrixXd moments(K * n * n, K * n * n);
  for (Index i = 0; i < K; ++i) {
    const Eigen::MatrixXd F = unpack(structure, model.theta.col(i)).full_form();
    for (Index j = 0; j < K; ++j)
      moments.block(j * n * n, i * n * n, n * n, n * n) = model.transition(i, j) * Eigen::kroneckerProduct(F, F).eval();
  }
  return moments.eigenvalues().cwiseAbs().maxCoeff();
}

/// A model with modes x[k+1] = F_j x[k].
SwitchingRegression model_of(const LinearStructure& structure, const std::vector<MatrixXd>& F, const MatrixXd& T) {
  const Index n = structure.dimension(), K = static_cast<Index>(F.size());
  SwitchingRegression model{MatrixXd(structure.parameters(), K),
                            std::vector<MatrixXd>(F.size(), MatrixXd::Identity(n, n)), T,
                            Eigen::VectorXd::Constant(K, 1.0 / static_cast<double>(K))};
  for (Index j = 0; j < K; ++j)
    model.theta.col(j) = (F[static_cast<std::size_t>(j)] - MatrixXd::Identity(n, n)).transpose().reshaped();
  return model;
}

double growth_of(const std::vector<MatrixXd>& F, const MatrixXd& T) {
  const LinearStructure structure{F.front().rows(), 0, false};
  return mean_square_growth(structure, model_of(structure, F, T));
}

MatrixXd sticky(Index modes, double stay) {
  return modes == 1 ? MatrixXd::Ones(1, 1) : TransitionMatrix::sticky(modes, stay).matrix();
}

/// A system with poles r e^(+-i w), as of an ARX(2) model.
MatrixXd oscillator(double r, double w) { return MatrixXd{{2.0 * r * std::cos(w), -r * r}, {1.0, 0.0}}; }

MatrixXd block_diagonal(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd F = MatrixXd::Zero(a.rows() + b.rows(), a.cols() + b.cols());
  F.topLeftCorner(a.rows(), a.cols()) = a;
  F.bottomRightCorner(b.rows(), b.cols()) = b;
  return F;
}

TEST(MeanSquareGrowth, OfScalarModesIsThatOfTheirSquares) {
  const LinearStructure scalar{1, 1, false};
  SwitchingRegression model{Eigen::MatrixXd{{-0.5, 0.2}, {0.0, 0.0}},
                            {Eigen::MatrixXd::Ones(1, 1), Eigen::MatrixXd::Ones(1, 1)},
                            Eigen::MatrixXd{{0.7, 0.3}, {0.7, 0.3}},
                            Eigen::Vector2d(0.5, 0.5)};
  EXPECT_NEAR(mean_square_growth(scalar, model), 0.7 * 0.25 + 0.3 * 1.44, 1e-12);  // independent draws of the mode: sum
                                                                                   // p_j f_j^2
  model.transition = Eigen::Matrix2d{{0.5, 0.5}, {0.01, 0.99}};
  EXPECT_GT(mean_square_growth(scalar, model), 1.0);
  model.transition = Eigen::Matrix2d{{0.9, 0.1}, {0.8, 0.2}};
  const Eigen::Matrix2d moments = (model.transition.transpose() * Eigen::Vector2d(0.25, 1.44).asDiagonal());
  EXPECT_NEAR(mean_square_growth(scalar, model), moments.eigenvalues().cwiseAbs().maxCoeff(), 1e-12);
}

// Poles of modulus 0.9. The moments of the modes rotate in phase, so a power iteration never converges.
TEST(MeanSquareGrowth, OfAnOscillatingModeIsItsSquaredRadius) {
  EXPECT_NEAR(growth_of({oscillator(0.9, 0.5)}, sticky(1, 1.0)), 0.81, 1e-12);
  EXPECT_NEAR(growth_of({oscillator(0.995, 0.5)}, sticky(1, 1.0)), 0.995 * 0.995, 1e-12);
  EXPECT_NEAR(growth_of({oscillator(0.9, 0.5), oscillator(0.9, 0.5)}, sticky(2, 0.97)), 0.81, 1e-12);
}

/// Up to 4 modes of up to 8 states: small operators are solved densely, large ones by Arnoldi's iteration.
TEST(MeanSquareGrowth, OfRandomSystemsIsTheDenseEigenvalue) {
  std::mt19937_64 generator(5);
  boost::random::normal_distribution<double> normal;
  boost::random::uniform_real_distribution<double> uniform;
  int iterated = 0;
  for (int system = 0; system < 50; ++system) {
    const Index K = 1 + system % 4, n = 2 + 2 * (system / 4 % 4);
    const LinearStructure structure{n, 0, false};
    std::vector<MatrixXd> F;
    for (Index j = 0; j < K; ++j) {
      MatrixXd one = MatrixXd::NullaryExpr(n, n, [&] { return normal(generator) / std::sqrt(static_cast<double>(n)); });
      if (system % 2 == 0)  // lightly damped oscillators in transformed coordinates
        for (one = oscillator(0.9 + 0.1 * uniform(generator), 3.0 * uniform(generator)); one.rows() < n;)
          one = block_diagonal(one, oscillator(0.9 + 0.1 * uniform(generator), 3.0 * uniform(generator)));
      F.push_back(one);
    }
    const SwitchingRegression model = model_of(structure, F, sticky(K, 0.3 + 0.699 * uniform(generator)));
    const double by_kronecker = growth_by_kronecker(structure, model);
    EXPECT_NEAR(mean_square_growth(structure, model), by_kronecker, 1e-8 * by_kronecker) << system;
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
      const double growth = growth_of(std::vector<MatrixXd>(static_cast<std::size_t>(K), F), sticky(K, 0.95));
      EXPECT_NEAR(growth, radius * radius, 1e-3) << K << '\n' << F;
      EXPECT_EQ(growth > 1.0 + refine_tuning.growth_slack, radius > 1.0) << "on the safe side of the threshold";
    }
  // Integrators with different steps have the same eigenvector. So a system of triangular modes grows like their
  // diagonals.
  const double several =
      growth_of({twice, MatrixXd{{1.0, 0.3}, {0.0, 1.0}}, MatrixXd{{1.0, -0.2}, {0.0, 1.0}}}, sticky(3, 0.9));
  EXPECT_NEAR(several, 1.0, 1e-4);
}

TEST(MeanSquareGrowth, OfAModeThatIsNotFiniteIsInfinite) {
  EXPECT_TRUE(std::isinf(growth_of({MatrixXd::Constant(2, 2, not_a_number), MatrixXd::Zero(2, 2)}, sticky(2, 0.9))));
}

}  // namespace
}  // namespace modebank
