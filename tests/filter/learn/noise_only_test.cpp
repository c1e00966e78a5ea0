// The competitors `noise_only` and `one_motion`. The theta of the first, standard errors and noise levels:
// tests/program/golden_test.py.
#include <gtest/gtest.h>

#include "filter/learn/chain/chain.hpp"
#include "tests/filter/learn/learn_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

TEST(NoiseOnly, StayIsTheMostLikelyOneOfTheTrainingRuns) {
  for (const char* size : {"scalar", "vector"}) {
    const nlohmann::json golden = test::read_golden("learn_noise_only").at(size);
    const Eigen::MatrixXd R = test::golden_rows(golden.at("R"));
    const auto columns = [](const auto& run, const char* name) { return test::golden_columns(run.at(name)); };
    Recording recording = test::empty_recording(R.rows(), columns(golden.at("runs")[0], "u").rows());
    for (const auto& run : golden.at("runs")) test::add_run(recording, columns(run, "x"), columns(run, "u"));
    const LinearStructure structure = test::structure_of(recording);
    const Bank bank = learn_noise_only(recording, structure, R);
    EXPECT_NEAR(bank.transition.matrix()(0, 0), golden.at("stay").get<double>(), 1e-10);
    EXPECT_TRUE(test::near(bank.R, R, 0.0));
    EXPECT_NO_THROW(check_sizes(bank));
    test::add_run(recording, 9.0 * recording.runs[0].state, recording.runs[0].input, Role::test);
    const Bank after = learn_noise_only(recording, structure, R);
    EXPECT_EQ(bank.theta(0), after.theta(0));
    for (std::size_t j = 0; j < 8; ++j) EXPECT_EQ(bank.modes[j].Q, after.modes[j].Q);
    EXPECT_EQ(bank.transition.matrix(), after.transition.matrix());
  }
}

TEST(NoiseOnly, ExactDataKeepVariancesPositive) {
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
  const Recording recording = test::simulated_runs(6, 200, 3, [](const auto& x, const auto& u, Index k, double w) {
    return 0.5 * x(k) + u(k) + (u(k) > 0.0 ? 0.5 : 0.02) * w;
  });
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
