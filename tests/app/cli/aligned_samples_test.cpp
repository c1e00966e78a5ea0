// Live samples and whole runs must be aligned in the same way, by holding and interpolation.
#include "app/cli/aligned_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace modebank::app {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A stream of one state and one input with jittering times.
struct Recorded {
  Stream state, input;

  Recorded(Index samples, double period_s, double jitter) {
    const VectorXd t = VectorXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1));
    state = {period_s * (t.array() + jitter * (7.0 * t.array()).sin()), (0.3 * t.array()).sin().matrix().transpose()};
    input = {state.time_s, (0.7 * t.array()).cos().matrix().transpose()};
  }
};

std::vector<TimedSample> aligned(const Recorded& run, const Alignment& alignment) {
  AlignedSamples samples(alignment);
  std::vector<TimedSample> all;
  for (Index k = 0; k < run.state.time_s.size(); ++k) {
    const double now_s = run.state.time_s(k);
    samples.push({now_s, run.input.values.col(k), run.state.values.col(k)});
    while (const TimedSample* const ready = samples.next()) {
      all.push_back(*ready);
      EXPECT_GE(now_s + 1e-9, std::max(ready->time_s, ready->time_s - alignment.lag_s)) << "before it is known";
    }
  }
  return all;
}

void expect_same(const std::vector<TimedSample>& samples, const VectorXd& time_s, const MatrixXd& state,
                 const MatrixXd& input) {
  ASSERT_EQ(std::ssize(samples), time_s.size());
  for (Index k = 0; k < time_s.size(); ++k) {
    const TimedSample& sample = samples[k];
    EXPECT_NEAR(sample.time_s, time_s(k), 1e-12);
    EXPECT_NEAR(sample.measurement(0), state(0, k), 1e-12) << k;
    EXPECT_NEAR(sample.input(0), input(0, k), 1e-12) << k;
  }
}

TEST(AlignedSamples, AreThoseOfTheWholeRun) {
  for (const double jitter : {0.0, 0.2})
    for (const double lag_s : {0.0, 0.17, -0.17, -0.5}) {
      SCOPED_TRACE(testing::Message() << "lag " << lag_s << ", jitter " << jitter);
      const Recorded run(400, 0.01, jitter);
      for (const double rate_hz : {0.0, 10.0, 33.0}) {
        const VectorXd time_s = joint_times(run.state.time_s, run.input.time_s, {rate_hz, lag_s});
        expect_same(aligned(run, {rate_hz, lag_s}), time_s, interpolate(run.state, time_s),
                    hold(run.input, time_s.array() - lag_s));
      }
      for (const double further_lag_s : {0.0, 0.05}) {
        if (lag_s == -0.5) continue;
        const VectorXd whole_s = joint_times(run.state.time_s, run.input.time_s, {10.0, lag_s});
        const VectorXd time_s = whole_s.tail(whole_s.size() - 1);
        expect_same(aligned(run, {10.0, lag_s, {{0}, {0}, further_lag_s}}), time_s,
                    average_ending(run.state, time_s, 0.1),
                    average_ending(run.input, time_s.array() - lag_s - further_lag_s, 0.1));
      }
    }
}

/// A log with a period of .07 s is too slow for averages at a rate of 10 Hz. A log with a period of .12 s is slower
/// than the rate: its samples keep their times.
TEST(AlignedSamples, AverageOnlyWhatIsFasterByHalf) {
  for (const double period_s : {0.07, 0.12}) {
    const Recorded run(50, period_s, 0.0);
    const std::vector<TimedSample> picked = aligned(run, {10.0, 0.0}), all = aligned(run, {10.0, 0.0, {{0}, {0}}});
    ASSERT_EQ(all.size(), picked.size());
    for (std::size_t k = 0; k < all.size(); ++k) EXPECT_EQ(all[k].measurement, picked[k].measurement);
    if (period_s == 0.12) expect_same(picked, run.state.time_s, run.state.values, run.input.values);
  }
}

/// After a pause, the first three samples of a fast log pass unchanged. Later samples come at the rate.
TEST(AlignedSamples, FindTheRateAfterAPause) {
  Recorded run(400, 0.01, 0.0);
  run.state.time_s.tail(399).array() += 0.7;
  const std::vector<TimedSample> samples = aligned(run, {10.0, 0.0, {{0}, {}}});
  ASSERT_GE(samples.size(), 30U);
  EXPECT_NEAR(samples[2].time_s, 0.72, 1e-12);
  const VectorXd time_s = VectorXd::Constant(1, 0.82);
  EXPECT_NEAR(samples[3].measurement(0), average_ending(run.state, time_s, 0.1)(0, 0), 1e-12);
  for (std::size_t k = 3; k < samples.size(); ++k) EXPECT_NEAR(samples[k].time_s - samples[k - 1].time_s, 0.1, 1e-9);
}

}  // namespace
}  // namespace modebank::app
