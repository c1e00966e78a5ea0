// Library results for pauses, and for regressors that the data leave unidentifiable.
#include <gmock/gmock.h>

#include <cmath>

#include "filter/step/gaussian.hpp"
#include "ident/data/streams.hpp"
#include "ident/fit/global_model.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// A pause changes the grid only deep inside the pause.
TEST(ClocksAndNumbersGrid, LeavesOutOnlyWhatLiesDeepInAPause) {
  VectorXd time_s(200);
  for (Index k = 0; k < 200; ++k) time_s(k) = 0.1 * static_cast<double>(k) + (k < 100 ? 0.0 : 5000.0);
  const VectorXd grid = joint_times(time_s, time_s, {10.0, 0.0});
  EXPECT_LT(grid.size(), 200 + 2 * 110);
  Index at = 0;
  for (double k = 0.0; k <= 50199.0; ++k) {
    const double time = 0.0 + k / 10.0;
    const bool deep = time > 9.9 + 9.95 && time < 5010.0 - 9.95;
    if (at < grid.size() && grid(at) == time)
      ++at;
    else
      EXPECT_TRUE(deep) << time;
  }
  EXPECT_EQ(at, grid.size()) << "times of the whole grid, and no others";
  for (Index k = 0; k < 200; ++k) time_s(k) = 0.1 * static_cast<double>(k) + (k < 100 ? 0.0 : 90.0);
  EXPECT_EQ(joint_times(time_s, time_s, {10.0, 0.0}).size(), 1100) << "a gap of 90 s at 10 Hz is short";
}

/// If the unidentifiable column is removed, the regression stays the same.
TEST(ClocksAndNumbersGlobal, Finding_D9_AnOpenRegressorDoesNotChangeTheOthers) {
  const auto recording = [](bool zero) {
    Recording result;
    result.states = {{"x", ""}};
    for (int i = 0; i < (zero ? 2 : 1); ++i) result.inputs.push_back({"u" + std::to_string(i), ""});
    Trajectory run;
    run.run = "a";
    run.role = Role::train;
    run.time_s = VectorXd::LinSpaced(60, 0.0, 5.9);
    run.state.resize(1, 60);
    run.input = Eigen::MatrixXd::Zero(zero ? 2 : 1, 60);
    for (Index k = 0; k < 60; ++k) {
      const double t = static_cast<double>(k);
      run.state(0, k) = std::sin(0.3 * t) + 0.1 * std::sin(7.0 * t);
      run.input(run.input.rows() - 1, k) = 1e-6 * std::cos(0.7 * t * t);
    }
    result.runs.push_back(std::move(run));
    return result;
  };
  const GlobalModel open = fit_global(recording(true), {1, 2}), whole = fit_global(recording(false), {1, 1});
  EXPECT_NEAR(open.theta(0), whole.theta(0), 1e-12);
  EXPECT_NEAR(open.theta(2) / whole.theta(1), 1.0, 1e-9);
  EXPECT_NEAR(open.covariance(0, 0) / whole.covariance(0, 0), 1.0, 1e-9);
  EXPECT_NEAR(open.covariance(2, 2) / whole.covariance(1, 1), 1.0, 1e-9);
  EXPECT_NEAR(open.covariance(0, 2) / whole.covariance(0, 1), 1.0, 1e-6);
  EXPECT_TRUE(std::isnan(open.covariance(1, 1)));
  EXPECT_EQ(unidentifiable_regressors(recording(true), {1, 2}), std::vector<Index>{1});
  EXPECT_EQ(unidentifiable_regressors(recording(false), {1, 1}), std::vector<Index>{});
}

}  // namespace
}  // namespace modebank::test
