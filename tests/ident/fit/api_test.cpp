#include <gtest/gtest.h>

#include <stdexcept>

#include "modebank/base/error.hpp"
#include "modebank/ident/windows.hpp"
#include "tests/ident/fit/decay.hpp"
#include "tests/ident/ident_test_support.hpp"
#include "tests/support/recorded_runs.hpp"

namespace modebank {
namespace {

Recording skid_recording() {
  std::mt19937_64 generator(5);
  std::vector<Trajectory> runs;
  for (const Role role : {Role::train, Role::test, Role::train}) {
    runs.push_back(test::gaussian_run(test::skid_structure, test::skid_theta, 0.05, 120, generator));
    runs.back().role = role;
  }
  runs.front().state(0, 40) = std::nan("");
  return test::make_recording(runs);
}

void expect_same(const ident::Windows& converted, const WindowFits& internal) {
  ASSERT_EQ(std::ssize(converted.run), internal.count());
  EXPECT_EQ(converted.parameter_names, internal.parameter_names());
  EXPECT_TRUE(test::same_bits(converted.theta, to_matrix(internal.parameters)));
  EXPECT_TRUE(test::same_bits(converted.covariance, to_matrix(internal.covariance)));
  EXPECT_TRUE(test::same_bits(converted.residual_sd, to_matrix(internal.noise_variance.cwiseSqrt())));
  EXPECT_TRUE(test::same_bits(converted.prior_sd, to_vector(internal.prior_sd)));
  EXPECT_TRUE(test::same_bits(converted.global_theta, to_vector(internal.global.theta)));
  for (std::size_t i = 0; i < converted.run.size(); ++i) {
    const auto w = static_cast<Index>(i);
    EXPECT_EQ(converted.run[i], internal.windows[i].run);
    EXPECT_EQ(converted.begin[i], internal.windows[i].start);
    EXPECT_EQ(converted.end[i], internal.windows[i].start + internal.length);
    EXPECT_EQ(converted.rank[i], internal.rank(w));
    EXPECT_EQ(static_cast<int>(converted.status[i]), internal.status(w));
  }
  EXPECT_EQ(std::ranges::count(converted.solver, WindowSolver::batch), std::ranges::count(internal.by_batch, 1));
}

TEST(IdentDoor, GivesTheSameBits) {
  const Recording recording = skid_recording();
  FitOptions batch, lags, plain;
  batch.solver = WindowSolver::batch;
  lags.model = "varx";
  lags.state_lags = 2;
  lags.covariance = CovarianceKind::sandwich;
  plain.loss = Loss::trivial;
  plain.prior = Prior::none;
  plain.step = 5;
  for (const FitOptions& options : {FitOptions(), batch, lags, plain})
    expect_same(ident::fit_windows(test::recorded_runs(recording), options), fit_windows(recording, options));
  const ident::Windows by_batch = ident::fit_windows(test::recorded_runs(recording), batch);
  EXPECT_GT(std::ranges::count(by_batch.solver, WindowSolver::batch), 100);
  EXPECT_EQ(std::ranges::count(by_batch.run, 1), 0) << "held out";
}

TEST(IdentDoor, TakesMotionModelsByNameAndOnesOwn) {
  EXPECT_EQ(ident::model_names(), (std::vector<std::string>{"linear", "varx", "icr", "slip"}));
  std::mt19937_64 generator(6);
  const Eigen::VectorXd both_tracks{{-1.0, 0.0, 0.5, 0.5, 0.0, -1.0, -1.0, 1.0}};  // centres of rotation at +-0.5 m
  const Recording skid = test::make_recording({test::gaussian_run({2, 2, false}, both_tracks, 0.01, 80, generator)});
  FitOptions icr;
  icr.model = "icr";
  expect_same(ident::fit_windows(test::recorded_runs(skid), icr), fit_windows(skid, icr));

  const auto own = models::make_decay({});
  FitOptions decay;
  decay.model = "decay";
  const Recording one =
      test::make_recording({test::gaussian_run({1, 1, false}, Eigen::Vector2d(-0.6, 0.7), 0.01, 80, generator)});
  expect_same(ident::fit_windows(test::recorded_runs(one), FitOptions(), *own), fit_windows(one, decay, *own));
  EXPECT_THROW(ident::fit_windows(test::recorded_runs(skid), FitOptions(), *own), std::invalid_argument);
}

/// The message of the exception for bad arguments.
std::string refusal(const RecordedRuns& runs, const FitOptions& options) {
  try {
    ident::fit_windows(runs, options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(IdentDoor, BadArgumentsAreNamed) {
  const RecordedRuns good = test::recorded_runs(skid_recording());
  FitOptions options;
  options.length = 0;
  EXPECT_EQ(refusal(good, options), "length = 0 is out of range: at least 1");
  options = {};
  options.prior_sd = {1.0, 1.0};
  EXPECT_EQ(refusal(good, options), "prior_sd = 2 values is out of range: one value, or one per parameter (3)");
  options = {};
  options.model = "sliip";
  EXPECT_NE(refusal(good, options).find("sliip"), std::string::npos);
  EXPECT_EQ(refusal({}, {}), "there are no runs");
  RecordedRuns bad = good;
  bad.runs[1].input.cols = 7;
  EXPECT_EQ(refusal(bad, {}), "run \"00\": input is 2 x 7, not 2 x 120");
  bad = good;
  bad.state_names = {"a", "b"};
  EXPECT_EQ(refusal(bad, {}), "there are 2 state_names for 1 rows of state");
  options = {};
  options.length = 500;
  EXPECT_THROW(ident::fit_windows(good, options), DataError);
}

}  // namespace
}  // namespace modebank
