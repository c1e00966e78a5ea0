// Several fits in one bank: how many, and what their union predicts.
#include "filter/learn/refine/averaging.hpp"

#include "tests/filter/learn/refine_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::adaptive_imm;
using test::near;
using test::start_bank;

using Averaging = test::RefineTest;

TEST_F(Averaging, FitsAreAveragedWhereRunsLeftOutGainByIt) {
  learn_from(6, 60);
  Eigen::MatrixXd many(2, 6);  // far more modes than so few samples tell apart: every start ends elsewhere
  many << truth.theta, 1.5 * truth.theta;
  RefineOptions options;
  options.restarts = 5;
  options.members = 4;
  options.screen = false;
  options.measurement_noise = false;  // so many modes on so few samples also gain by an R, and then there is one fit
  const WindowFits fits = test::windows_of(recording, 25, 1);
  const Refinement refined = refine_bank(recording, fits, {start_bank(recording, many)}, options, adaptive_imm());
  ASSERT_GT(refined.averaging.members, 1);
  EXPECT_LE(refined.averaging.members, 4);
  EXPECT_GT(refined.averaging.score, refined.averaging.score_before);
  EXPECT_EQ(refined.bank.mode_count(), 6 * refined.averaging.members);
  Index selected = 0;
  for (const RefineCandidate& c : refined.candidates) selected += c.selected ? 1 : 0;
  EXPECT_EQ(selected, refined.averaging.members);
  double weights = 0.0;
  for (const Mode& mode : refined.bank.modes) {
    weights += mode.weight;
    EXPECT_TRUE(mode.standard_error.allFinite());
  }
  EXPECT_NEAR(weights, 1.0, 1e-12);
}

TEST_F(Averaging, OneFitIsKeptWhereAllStartsEndThere) {
  learn_from(4, 400);
  RefineOptions options;
  options.restarts = 0;
  options.members = 4;
  const WindowFits fits = test::windows_of(recording, 25, 1);
  Eigen::MatrixXd elsewhere = truth.theta;
  elsewhere.row(1) += Eigen::RowVector3d(0.05, -0.05, 0.05);
  const Bank first = start_bank(recording, truth.theta), second = start_bank(recording, elsewhere);
  const Bank smaller = start_bank(recording, truth.theta.leftCols(2));
  const Refinement refined = refine_bank(recording, fits, {first, second, smaller}, options, {});
  EXPECT_EQ(refined.averaging.members, 1);
  EXPECT_EQ(refined.bank.mode_count(), 3);
}

class UnitedBank : public test::RefineTest {
 protected:
  Bank bank_of(double scale) {
    Bank bank = start_bank(recording, scale * truth.theta);
    for (Index j = 0; j < 3; ++j) bank.modes[static_cast<std::size_t>(j)].Q(0, 0) = truth.Q(j);
    bank.transition = TransitionMatrix(truth.T);
    return bank;
  }
};

TEST_F(UnitedBank, WithoutSwitchingIsBayesianModelAveraging) {
  learn_from(1, 80);
  const Bank first = bank_of(1.0), second = bank_of(0.8);
  const Trajectory& run = recording.runs.front();
  const double a = log_likelihood(first, run, {}), b = log_likelihood(second, run, {});
  EXPECT_NEAR(log_likelihood(unite({first, second}, 0.0), run, {}), b + std::log(0.5 * (1.0 + std::exp(a - b))), 1e-9);
  EXPECT_NEAR(log_likelihood(unite({first, first, first}, 0.0), run, {}), a, 1e-9);
}

TEST_F(UnitedBank, SwitchingKeepsTheLongRunShares) {
  learn_from(1, 20);
  const Bank united = unite({bank_of(1.0), bank_of(0.8)}, 0.05);
  ASSERT_EQ(united.mode_count(), 6);
  const Eigen::MatrixXd& T = united.transition.matrix();
  EXPECT_TRUE(near(T.rowwise().sum(), Eigen::VectorXd::Ones(6), 1e-15));
  Eigen::RowVectorXd share = Eigen::RowVectorXd::Constant(3, 1.0 / 3.0);
  for (int i = 0; i < 5000; ++i) share = (share * truth.T).eval();
  Eigen::RowVectorXd both(6);
  both << 0.5 * share, 0.5 * share;
  EXPECT_TRUE(near(Eigen::MatrixXd(both * T), Eigen::MatrixXd(both), 1e-9));
  EXPECT_NEAR(T.row(0).tail(3).sum(), 0.025, 1e-12);
  EXPECT_THROW(unite({}, 0.1), std::invalid_argument);
}

}  // namespace
}  // namespace modebank
