#include <gtest/gtest.h>

#include <stdexcept>

#include "filter/step/bank.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

constexpr double matrix_rounding = 1e-15;

TEST(TransitionMatrix, KeepsARowStochasticMatrix) {
  const Eigen::MatrixXd T = (Eigen::MatrixXd(2, 2) << 0.95, 0.05, 0.10, 0.90).finished();
  EXPECT_TRUE(test::near(TransitionMatrix(T).matrix(), T, matrix_rounding));
}

TEST(TransitionMatrix, NormalisesRowsWithinTheTolerance) {
  const Eigen::MatrixXd T = (Eigen::MatrixXd(2, 2) << 0.95 + 5e-10, 0.05, 0.10, 0.90).finished();
  EXPECT_NEAR(TransitionMatrix(T).matrix().row(0).sum(), 1.0, matrix_rounding);
}

TEST(TransitionMatrix, RejectsWhatIsNotRowStochastic) {
  EXPECT_THROW(TransitionMatrix(Eigen::MatrixXd::Constant(2, 3, 1.0 / 3.0)), std::invalid_argument);
  EXPECT_THROW(TransitionMatrix(Eigen::MatrixXd(0, 0)), std::invalid_argument);
  EXPECT_THROW(TransitionMatrix(Eigen::MatrixXd::Constant(2, 2, 0.5 + 1e-8)), std::invalid_argument);
  EXPECT_THROW(TransitionMatrix((Eigen::MatrixXd(2, 2) << 1.1, -0.1, 0.5, 0.5).finished()), std::invalid_argument);
  EXPECT_THROW(TransitionMatrix(Eigen::MatrixXd::Constant(1, 1, std::nan(""))), std::invalid_argument);
  // Columns sum to one, and rows do not. This happens if a caller passes mixing weights by mistake.
  EXPECT_THROW(TransitionMatrix((Eigen::MatrixXd(2, 2) << 0.9, 0.3, 0.1, 0.7).finished()), std::invalid_argument);
}

TEST(TransitionMatrix, StickySpreadsTheRestEqually) {
  const Eigen::MatrixXd expected =
      (Eigen::MatrixXd(3, 3) << 0.9, 0.05, 0.05, 0.05, 0.9, 0.05, 0.05, 0.05, 0.9).finished();
  EXPECT_TRUE(test::near(TransitionMatrix::sticky(3, 0.9).matrix(), expected, matrix_rounding));
  EXPECT_EQ(TransitionMatrix::sticky(1, 0.3).matrix()(0, 0), 1.0);
  EXPECT_THROW(TransitionMatrix::sticky(0, 0.9), std::invalid_argument);
  EXPECT_THROW(TransitionMatrix::sticky(2, 1.1), std::invalid_argument);
}

}  // namespace
}  // namespace modebank
