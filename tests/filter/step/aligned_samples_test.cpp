// Live samples and whole runs must be aligned in the same way, by holding and interpolation.
#include "filter/step/aligned_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "ident/data/streams.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A stream of one state and one input with jittering times.
struct Recorded {
  VectorXd time_s;
  MatrixXd state, input;

  Recorded(Index samples, double period_s, double jitter) : time_s(samples), state(1, samples), input(1, samples) {
    for (Index k = 0; k < samples; ++k) {
      const double t = static_cast<double>(k);
      time_s(k) = period_s * (t + jitter * std::sin(7.0 * t));
      state(0, k) = std::sin(0.3 * t);
      input(0, k) = std::cos(0.7 * t);
    }
  }
};

std::vector<TimedSample> aligned(const Recorded& run, const Alignment& alignment) {
  AlignedSamples samples(alignment);
  std::vector<TimedSample> all;
  for (Index k = 0; k < run.time_s.size(); ++k) {
    samples.push({run.time_s(k), run.input.col(k), run.state.col(k)});
    while (const TimedSample* const ready = samples.next()) {
      all.push_back(*ready);
      EXPECT_GE(run.time_s(k) + 1e-9, std::max(ready->time_s, ready->time_s - alignment.lag_s)) << "before it is known";
    }
  }
  return all;
}

TEST(AlignedSamples, AreThoseOfTheWholeRun) {
  for (const double jitter : {0.0, 0.2})
    for (const double lag_s : {0.0, 0.17, -0.17, -0.5})
      for (const double rate_hz : {0.0, 10.0, 33.0}) {
        const Recorded run(400, 0.01, jitter);
        const VectorXd time_s = joint_times(run.time_s, run.time_s, {rate_hz, lag_s});
        const MatrixXd state = interpolate({run.time_s, run.state}, time_s);
        const MatrixXd input = hold({run.time_s, run.input}, time_s.array() - lag_s);
        const std::vector<TimedSample> samples = aligned(run, {rate_hz, lag_s});
        ASSERT_EQ(std::ssize(samples), time_s.size()) << "lag " << lag_s << ", rate " << rate_hz << ", " << jitter;
        for (Index k = 0; k < time_s.size(); ++k) {
          const TimedSample& sample = samples[static_cast<std::size_t>(k)];
          EXPECT_NEAR(sample.time_s, time_s(k), 1e-12);
          EXPECT_NEAR(sample.measurement(0), state(0, k), 1e-12);
          EXPECT_EQ(sample.input(0), input(0, k)) << "lag " << lag_s << ", rate " << rate_hz << ", sample " << k;
        }
      }
}

TEST(AlignedSamples, AverageWhatTheWholeRunAverages) {
  for (const double jitter : {0.0, 0.2})
    for (const double lag_s : {0.0, 0.17, -0.17})
      for (const double further_lag_s : {0.0, 0.05}) {
        const Recorded run(400, 0.01, jitter);
        const VectorXd whole_s = joint_times(run.time_s, run.time_s, {10.0, lag_s});
        const VectorXd time_s = whole_s.tail(whole_s.size() - 1);
        const MatrixXd state = average_ending({run.time_s, run.state}, time_s, 0.1);
        const VectorXd recorded_s = time_s.array() - lag_s - further_lag_s;
        const MatrixXd input = average_ending({run.time_s, run.input}, recorded_s, 0.1);
        const std::vector<TimedSample> samples = aligned(run, {10.0, lag_s, {{0}, {0}, further_lag_s}});
        ASSERT_EQ(std::ssize(samples), time_s.size()) << "lag " << lag_s << ", " << jitter;
        for (Index k = 0; k < time_s.size(); ++k) {
          const TimedSample& sample = samples[static_cast<std::size_t>(k)];
          EXPECT_NEAR(sample.time_s, time_s(k), 1e-12);
          EXPECT_NEAR(sample.measurement(0), state(0, k), 1e-12) << k;
          EXPECT_NEAR(sample.input(0), input(0, k), 1e-12) << "lag " << lag_s << ", sample " << k;
        }
      }
}

/// A log with a period of .07 s is too slow for averages at a rate of 10 Hz. A log with a period of .12 s is slower
/// than the rate.
TEST(AlignedSamples, AverageOnlyWhatIsFasterByHalf) {
  for (const double period_s : {0.07, 0.12}) {
    const Recorded run(50, period_s, 0.0);
    const std::vector<TimedSample> picked = aligned(run, {10.0, 0.0}), all = aligned(run, {10.0, 0.0, {{0}, {0}}});
    ASSERT_EQ(all.size(), picked.size());
    for (std::size_t k = 0; k < all.size(); ++k) EXPECT_EQ(all[k].measurement, picked[k].measurement);
  }
}

TEST(AlignedSamples, OfASlowStreamKeepTheirTimes) {
  const Recorded run(50, 0.1, 0.2);
  const std::vector<TimedSample> samples = aligned(run, {10.0, 0.0});
  ASSERT_EQ(samples.size(), 50U);
  for (Index k = 0; k < 50; ++k) EXPECT_EQ(samples[static_cast<std::size_t>(k)].time_s, run.time_s(k));
}

/// After a pause, the first three samples of a fast log pass unchanged. Later samples come at the rate.
TEST(AlignedSamples, FindTheRateAfterAPause) {
  Recorded run(400, 0.01, 0.0);
  run.time_s.tail(399).array() += 0.7;
  const std::vector<TimedSample> samples = aligned(run, {10.0, 0.0, {{0}, {}}});
  ASSERT_GE(samples.size(), 30U);
  EXPECT_NEAR(samples[2].time_s, 0.72, 1e-12);
  const VectorXd time_s = VectorXd::Constant(1, 0.82);
  EXPECT_NEAR(samples[3].time_s, time_s(0), 1e-12);
  EXPECT_NEAR(samples[3].measurement(0), average_ending({run.time_s, run.state}, time_s, 0.1)(0, 0), 1e-12);
  for (std::size_t k = 4; k < samples.size(); ++k) EXPECT_NEAR(samples[k].time_s - samples[k - 1].time_s, 0.1, 1e-9);
}

}  // namespace
}  // namespace modebank
