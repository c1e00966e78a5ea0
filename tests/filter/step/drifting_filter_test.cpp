// The drifting model live: snapshots, what it refuses, samples as they should not be.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>
#include <vector>

#include "filter/judge/run/drifting.hpp"
#include "filter/step/drifting.hpp"
#include "tests/filter/drifting_test_support.hpp"

namespace modebank {
namespace {

using test::example_drifting;
using test::holed;
using test::simulate_drifting;

TEST(DriftingFilter, GoesOnFromASnapshotAndStartsAnew) {
  DriftingModel model = example_drifting(2, 1, 2);
  model.dt_s = 1.0;
  const Trajectory run = holed(simulate_drifting(model, 140, 8));
  const RunEvaluation whole = evaluate_run(model, run);
  DriftingFilter first(model), second(model);
  const auto step = [&](DriftingFilter& filter, Index k) {
    return filter.step(run.time_s(k), run.input.col(k), run.state.col(k)).log_density;
  };
  for (Index k = 0; k < 47; ++k) step(first, k);
  second.restore(first.snapshot());
  EXPECT_TRUE(second.started());
  for (Index k = 47; k < run.samples(); ++k) {
    const double log_density = step(second, k);
    EXPECT_TRUE(std::isnan(log_density) ? std::isnan(whole.log_density(k)) : log_density == whole.log_density(k));
  }
  second.restart();
  EXPECT_FALSE(second.started());
  for (Index k = 0; k < 20; ++k) {
    const double log_density = step(second, k);
    EXPECT_TRUE(std::isnan(log_density) ? std::isnan(whole.log_density(k)) : log_density == whole.log_density(k));
  }
}

TEST(DriftingFilter, RefusesWhatIsNone) {
  const DriftingModel good = example_drifting(2, 1, 2);
  EXPECT_NO_THROW(DriftingFilter{good});
  const std::vector<std::function<void(DriftingModel&)>> spoil = {
      [](DriftingModel& m) { m.theta0(0) = std::nan(""); },
      [](DriftingModel& m) { m.theta0.conservativeResize(3); },
      [](DriftingModel& m) { m.scale(1) = 0.0; },
      [](DriftingModel& m) { m.v0(0) = 0.0; },
      [](DriftingModel& m) { m.variance_floor(1) = -1.0; },
      [](DriftingModel& m) { m.rates.q = -1.0; },
      [](DriftingModel& m) { m.rates.p0 = INFINITY; },
      [](DriftingModel& m) { m.rates.leak = 1.1; },
      [](DriftingModel& m) { m.lam = std::nan(""); },
      [](DriftingModel& m) { m.nu = 2.0; },
      [](DriftingModel& m) {
        m.horizon_factor = {{1, 2.0}};
      },
      [](DriftingModel& m) {
        m.horizon_factor = {{5, 0.0}};
      },
  };
  for (std::size_t i = 0; i < spoil.size(); ++i) {
    DriftingModel bad = good;
    spoil[i](bad);
    EXPECT_THROW(DriftingFilter{bad}, std::invalid_argument) << i;
  }
  DriftingFilter filter(good);
  EXPECT_THROW(filter.restore(DriftingFilter(example_drifting(2, 1, 1)).snapshot()), std::invalid_argument);
  DriftingSnapshot odd = filter.snapshot();
  odd.coefficients.theta(0, 0) = std::nan("");
  EXPECT_THROW(filter.restore(odd), std::invalid_argument);
}

/// Whatever comes in, numbers come out.
TEST(DriftingFilter, StaysFiniteOnWildSamples) {
  for (const double huge : {1e8, 1e25}) {
    DriftingModel model = example_drifting(1, 1, 2);
    model.theta0.setConstant(1.0);  // unstable
    Trajectory run = simulate_drifting(example_drifting(1, 1, 2), 300, 4);
    run.state.col(50).setConstant(huge);
    run.state.middleCols(100, 120).setConstant(std::nan(""));
    const RunEvaluation e = evaluate_run(model, run);
    EXPECT_TRUE(e.state.rightCols(298).allFinite());
    for (Index k = 2; k < 300; ++k) ASSERT_TRUE(std::isfinite(e.log_density(k)) || (k >= 100 && k < 220)) << k;
    const HorizonEvaluation ahead = evaluate_horizons(model, run, {40});
    for (Index k = 41; k < 300; ++k) ASSERT_TRUE(std::isfinite(ahead.log_density(0, k)) || (k >= 100 && k < 220)) << k;
  }
}

TEST(DriftingFilter, StaysFiniteWhereSamplesAreOfEverySize) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    DriftingModel model = example_drifting(2, 1, 2);
    model.rates = {seed % 2 == 0 ? 0.0 : 0.1, 1e4, 1.0};
    Trajectory run = simulate_drifting(example_drifting(2, 1, 2), 200, seed);
    std::mt19937_64 generator(seed);
    for (double& value : run.state.reshaped())
      value *= std::pow(10.0, 29.0 * boost::random::uniform_01<double>()(generator));
    const RunEvaluation e = evaluate_run(model, run);
    EXPECT_TRUE(e.state.rightCols(198).allFinite());
    EXPECT_TRUE(e.log_density.tail(198).allFinite());
    EXPECT_TRUE(e.innovation_covariance.rightCols(198).allFinite());
  }
}

}  // namespace
}  // namespace modebank
