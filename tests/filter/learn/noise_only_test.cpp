// The competitor `noise_only` compared with statsmodels, numpy and the textbook filter
// (tests/golden/generate/learn_reference.py).
#include <gtest/gtest.h>

#include <array>

#include "filter/learn/likelihood/training_likelihood.hpp"
#include "ident/fit/robust_regression.hpp"
#include "tests/filter/learn/learn_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;

/// Both implementations iterate until theta changes by less than 1e-12.
constexpr double noise_exact = 1e-10;

class NoiseOnly : public testing::TestWithParam<const char*> {
 protected:
  nlohmann::json golden = test::read_golden("learn_noise_only").at(GetParam());
  Recording recording = test::golden_recording(golden.at("runs"));
  LinearStructure structure = test::structure_of(recording);
};

TEST_P(NoiseOnly, ThetaIsHubersRegression) {
  const RobustRegression fit = huber_regression(stack_training(recording, structure));
  EXPECT_TRUE(fit.converged);
  EXPECT_TRUE(near(fit.coefficients.reshaped(), test::golden_rows(golden.at("theta")), noise_exact));
  EXPECT_TRUE(near(fit.scale, test::golden_rows(golden.at("scale")), noise_exact));
  EXPECT_TRUE(near(fit.standard_error.reshaped(), test::golden_rows(golden.at("standard_error")), noise_exact));
}

TEST_P(NoiseOnly, ScalesLieBetweenTheQuantiles) {
  const Bank bank = learn_noise_only(recording, structure, test::golden_rows(golden.at("R")));
  const Eigen::MatrixXd variances = test::golden_rows(golden.at("variances"));
  ASSERT_EQ(bank.mode_count(), 8);
  for (Index j = 0; j < 8; ++j) {
    EXPECT_TRUE(near(bank.modes[j].Q, variances.col(j).asDiagonal().toDenseMatrix(), noise_exact)) << "mode " << j;
    EXPECT_TRUE(near(bank.theta(j), test::golden_rows(golden.at("theta")), noise_exact)) << "mode " << j;
    EXPECT_NEAR(bank.modes[j].weight, 0.125, noise_exact);
  }
  EXPECT_NO_THROW(check_sizes(bank));
}

TEST_P(NoiseOnly, StayIsTheMostLikelyOne) {
  Bank bank = learn_noise_only(recording, structure, test::golden_rows(golden.at("R")));
  EXPECT_NEAR(bank.transition.matrix()(0, 0), golden.at("stay").get<double>(), noise_exact);
  EXPECT_TRUE(near(bank.R, test::golden_rows(golden.at("R")), 0.0));
  for (std::size_t i = 0; i < golden.at("stays").size(); ++i) {
    bank.transition = TransitionMatrix::sticky(8, golden.at("stays")[i].get<double>());
    // tolerance for a sum over a hundred samples; each density agrees to 1e-10
    EXPECT_NEAR(training_log_likelihood(bank, recording, {}), golden.at("log_likelihood")[i].get<double>(), 1e-8);
  }
}

TEST_P(NoiseOnly, TestRunsDoNotMatter) {
  const Eigen::MatrixXd R = test::golden_rows(golden.at("R"));
  const Bank before = learn_noise_only(recording, structure, R);
  test::add_run(recording, 9.0 * recording.runs[0].state, recording.runs[0].input, Role::test);
  const Bank after = learn_noise_only(recording, structure, R);
  for (Index j = 0; j < 8; ++j) {
    EXPECT_EQ(before.theta(j), after.theta(j));
    EXPECT_EQ(before.modes[j].Q, after.modes[j].Q);
  }
  EXPECT_EQ(before.transition.matrix(), after.transition.matrix());
}

INSTANTIATE_TEST_SUITE_P(Sizes, NoiseOnly, testing::Values("scalar", "vector"),
                         [](const auto& instance) { return std::string(instance.param); });

TEST(NoiseOnlyEdge, ExactDataKeepVariancesPositive) {
  Recording recording = test::empty_recording(1, 1);
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, 40), u = Eigen::MatrixXd::Zero(1, 40);
  x.rightCols(3) << 0.1, 0.3, 0.2;  // more than half of the residuals are zero
  test::add_run(recording, x, u);
  const Bank bank = learn_noise_only(recording, test::structure_of(recording), Eigen::MatrixXd::Constant(1, 1, 1e-6));
  for (const Mode& mode : bank.modes) EXPECT_GT(mode.Q(0, 0), 0.0);
  EXPECT_TRUE(bank.theta(0).allFinite());
}

}  // namespace
}  // namespace modebank
