// The competitors `noise_only` and `one_motion`. The theta of the first, standard errors and noise levels:
// tests/program/golden_test.py.
#include <gtest/gtest.h>

#include <boost/random/normal_distribution.hpp>
#include <random>

#include "filter/learn/chain/chain.hpp"
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

TEST_P(NoiseOnly, StayIsTheMostLikelyOne) {
  const Bank bank = learn_noise_only(recording, structure, test::golden_rows(golden.at("R")));
  EXPECT_NEAR(bank.transition.matrix()(0, 0), golden.at("stay").get<double>(), noise_exact);
  EXPECT_TRUE(near(bank.R, test::golden_rows(golden.at("R")), 0.0));
  EXPECT_NO_THROW(check_sizes(bank));
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

/// Noise that follows the input by a step, as a bank with logit transitions may know it. A rival without such
/// transitions would leave their gain to the modes.
TEST(OneMotion, HasTheBanksTransitionsByStateAndInput) {
  std::mt19937_64 generator(3);
  boost::random::normal_distribution<double> normal;
  Recording recording = test::empty_recording(1, 1);
  for (int run = 0; run < 6; ++run) {
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, 200), u(1, 200);
    for (Index k = 0; k < 200; ++k) {
      u(k) = normal(generator);
      if (k < 199) x(k + 1) = 0.5 * x(k) + u(k) + (u(k) > 0.0 ? 0.5 : 0.02) * normal(generator);
    }
    test::add_run(recording, x, u);
  }
  LearningOptions options;
  options.terms = "none";
  options.mixture.selection.components = {2};
  options.bank.transition = TransitionSource::logit;
  Learning learned;
  learn_all(recording, options, Stage::bank, {}, learned);
  EXPECT_FALSE(learned.one_motion->transition_logit.empty());
}

}  // namespace
}  // namespace modebank
