#include <gtest/gtest.h>

#include "filter/learn/learn.hpp"
#include "filter/learn/refine/refine.hpp"
#include "tests/filter/drifting_test_support.hpp"
#include "tests/filter/learn/learn_test_support.hpp"

namespace modebank {
namespace {

/// Eight runs of one system whose coefficients drift at these rates.
Recording wandering_runs(const DriftRates& rates, std::uint64_t seed) {
  Bank model = test::example_drifting(1, 1, 1);
  model.drift.scale.setOnes();
  model.drift.rates = rates;
  model.running_noise.nu = 0.0;
  Recording recording = test::empty_recording(1, 1);
  for (std::uint64_t run = 0; run < 8; ++run) {
    const Trajectory simulated = test::simulate_drifting(model, 200, 8 * seed + run);
    test::add_run(recording, simulated.state, simulated.input);
  }
  return recording;
}

WindowFits affine_windows(const Recording& recording) {
  WindowFits fits = test::windows_of(recording, 25, 5);
  fits.structure.intercept = true;
  fits.global = fit_global(recording, fits.structure);
  return fits;
}

/// Two ways of learning one motion: as a bank of one mode, and as the competitor.
Refinement refined(const Recording& recording, Drift drift, bool competitor) {
  const WindowFits fits = affine_windows(recording);
  BankOptions options;
  options.em.drift = drift;
  options.em.measurement_noise = false;
  options.em.restarts = 0;
  options.em.folds = 4;
  const Bank start = learn_baseline(recording, fits.global, fits.structure).bank;
  if (competitor) return learn_one_motion(recording, fits, fits.global, start, start.R, 1, options, {});
  return refine_bank(recording, fits, {start}, options.em, {});
}

constexpr DriftRates wandering{0.02, 2.0, 0.97}, no_drift{0.0, 0.0, 1.0};

TEST(DriftChoice, TakesDriftWhereCoefficientsWander) {
  for (const bool competitor : {false, true}) {
    const Refinement r = refined(wandering_runs(wandering, 1), Drift::automatic, competitor);
    EXPECT_TRUE(r.drift.taken);
    EXPECT_FALSE(r.bank.drift.empty()) << "otherwise what drift is worth would be counted for the modes";
    EXPECT_GT(r.drift.gain, 2.0 * r.drift.gain_standard_error);
    EXPECT_GT(r.drift.start, 0.0);
    EXPECT_TRUE(refined(wandering_runs(wandering, 1), Drift::none, competitor).bank.drift.empty());
  }
}

TEST(DriftChoice, LeavesItWhereTheyDoNot) {
  int taken = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    const Refinement r = refined(wandering_runs(no_drift, seed), Drift::automatic, false);
    EXPECT_LT(r.drift.gain, 0.02) << "seed " << seed;
    taken += r.drift.taken ? 1 : 0;
  }
  EXPECT_EQ(taken, 0) << "of six";
}

}  // namespace
}  // namespace modebank
