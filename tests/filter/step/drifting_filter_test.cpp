// The drifting model sample by sample: snapshots, rejected inputs, unusual samples.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>
#include <vector>

#include "filter/judge/horizon.hpp"
#include "filter/step/bank_filter.hpp"
#include "tests/filter/drifting_test_support.hpp"

namespace modebank {
namespace {

using test::example_drifting;
using test::holed;
using test::simulate_drifting;

TEST(DriftingFilter, GoesOnFromASnapshotAndStartsAnew) {
  Bank model = test::with_levels(example_drifting(2, 1, 2));
  model.dt_s = 1.0;
  const Trajectory run = holed(simulate_drifting(model, 140, 8));
  const RunEvaluation whole = evaluate_run(model, run, {});
  BankFilter first(model, {}), second(model, {});
  const auto step = [&](BankFilter& filter, Index k) {
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
  const Bank good = example_drifting(2, 1, 2);
  EXPECT_NO_THROW(BankFilter(good, {}));
  const std::vector<std::function<void(Bank&)>> spoil = {
      [](Bank& m) { m.modes.front().model.A(0, 0) = std::nan(""); },
      [](Bank& m) { m.modes.push_back(m.modes.front()); },
      [](Bank& m) { m.drift = {}; },
      [](Bank& m) { m.R(0, 0) = 1e-3; },
      [](Bank& m) { m.drift.scale(1) = 0.0; },
      [](Bank& m) { m.noise_variance()(0) = 0.0; },
      [](Bank& m) { m.running_noise.floor(1) = -1.0; },
      [](Bank& m) { m.drift.rates.q = -1.0; },
      [](Bank& m) { m.drift.rates.p0 = INFINITY; },
      [](Bank& m) { m.drift.rates.leak = 1.1; },
      [](Bank& m) { m.running_noise.lam = std::nan(""); },
      [](Bank& m) { m.running_noise.nu = 2.0; },
      [](Bank& m) {
        m.running_noise.horizon_factor = {{1, 2.0}};
      },
      [](Bank& m) {
        m.running_noise.horizon_factor = {{5, 0.0}};
      },
  };
  for (std::size_t i = 0; i < spoil.size(); ++i) {
    Bank bad = good;
    spoil[i](bad);
    EXPECT_THROW(BankFilter(bad, {}), std::invalid_argument) << i;
  }
  BankFilter filter(good, {});
  EXPECT_THROW(filter.restore(BankFilter(example_drifting(2, 1, 1), {}).snapshot()), std::invalid_argument);
  std::vector<double> odd = filter.snapshot();
  odd[10] = std::nan("");  // theta(0, 0), after two numbers, z and the sizes of both
  EXPECT_THROW(filter.restore(odd), std::invalid_argument);
}

/// Any input must give finite numbers.
TEST(DriftingFilter, StaysFiniteOnWildSamples) {
  for (const double huge : {1e8, 1e25}) {
    Bank model = example_drifting(1, 1, 2);
    model.modes.front().model =
        unpack(model.structure, Eigen::VectorXd::Ones(model.structure.parameters()));  // unstable
    Trajectory run = simulate_drifting(example_drifting(1, 1, 2), 300, 4);
    run.state.col(50).setConstant(huge);
    run.state.middleCols(100, 120).setConstant(std::nan(""));
    const RunEvaluation e = evaluate_run(model, run, {});
    EXPECT_TRUE(e.state.rightCols(298).allFinite());
    for (Index k = 2; k < 300; ++k) ASSERT_TRUE(std::isfinite(e.log_density(k)) || (k >= 100 && k < 220)) << k;
    const HorizonEvaluation ahead = evaluate_horizons(model, run, {}, {40});
    for (Index k = 41; k < 300; ++k) ASSERT_TRUE(std::isfinite(ahead.log_density(0, k)) || (k >= 100 && k < 220)) << k;
  }
}

TEST(DriftingFilter, StaysFiniteWhereSamplesAreOfEverySize) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Bank model = example_drifting(2, 1, 2);
    if (seed > 10) model = test::with_levels(model);
    model.drift.rates = {seed % 2 == 0 ? 0.0 : 0.1, 1e4, 1.0};
    Trajectory run = simulate_drifting(example_drifting(2, 1, 2), 200, seed);
    std::mt19937_64 generator(seed);
    for (double& value : run.state.reshaped())
      value *= std::pow(10.0, 29.0 * boost::random::uniform_01<double>()(generator));
    const RunEvaluation e = evaluate_run(model, run, {});
    EXPECT_TRUE(e.state.rightCols(198).allFinite());
    EXPECT_TRUE(e.log_density.tail(198).allFinite());
    EXPECT_TRUE(e.innovation_covariance.rightCols(198).allFinite());
  }
}

}  // namespace
}  // namespace modebank
