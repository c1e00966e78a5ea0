// Robots without slip, with known width, wheels, delays and noise. The test counts how often an exported number is
// within two standard errors of the true number. MODEBANK_EXPORT_SEEDS: the number of robots (make export-recovery:
// 1000), or a range such as 301-1000.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <utility>

#include "app/text/robot_numbers.hpp"
#include "filter/learn/learn.hpp"
#include "ident/fit/fit_windows.hpp"
#include "tests/app/export/exported.hpp"

namespace modebank::app::test {
namespace {

constexpr std::array<const char*, 7> names{"separation",  "left wheel",  "right wheel", "delay of wz",
                                           "delay of vx", "noise of wz", "noise of vx"};
using Truth = std::array<double, names.size()>;

/// True parameters of a robot, drawn for every seed.
struct Robot {
  double separation_m, left, right, yaw_time_s, forward_time_s, yaw_variance, forward_variance, dt_s = 0.1;

  explicit Robot(std::mt19937_64& generator) {
    boost::random::uniform_01<double> uniform;
    separation_m = 0.4 + 0.6 * uniform(generator);
    left = 0.9 + 0.2 * uniform(generator);
    right = 0.9 + 0.2 * uniform(generator);
    yaw_time_s = 0.1 + 0.3 * uniform(generator);
    forward_time_s = 0.1 + 0.3 * uniform(generator);
    yaw_variance = 1e-4 + 1e-3 * uniform(generator);
    forward_variance = 1e-4 + 1e-3 * uniform(generator);
  }
  Truth truth() const {
    const double half = 0.5 * dt_s;
    return {separation_m,
            left,
            right,
            half / std::tanh(half / yaw_time_s),
            half / std::tanh(half / forward_time_s),
            yaw_variance / dt_s,
            forward_variance / dt_s};
  }
};

Trajectory drive(const Robot& robot, Index samples, std::mt19937_64& generator) {
  boost::random::normal_distribution<double> normal;
  boost::random::uniform_01<double> uniform;
  Trajectory run;
  run.time_s = robot.dt_s * Eigen::VectorXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1));
  run.state.setZero(2, samples);
  run.input.resize(2, samples);
  Eigen::Vector2d speeds = Eigen::Vector2d::Zero();
  const double f = std::exp(-robot.dt_s / robot.yaw_time_s), g = std::exp(-robot.dt_s / robot.forward_time_s);
  for (Index k = 0; k < samples; ++k) {
    if (k % 8 == 0) speeds = Eigen::Vector2d(uniform(generator) - 0.3, uniform(generator) - 0.3);
    run.input.col(k) = speeds;
    if (k + 1 == samples) break;
    const double left = robot.left * speeds(0), right = robot.right * speeds(1);
    run.state(0, k + 1) = f * run.state(0, k) + (1.0 - f) * (right - left) / robot.separation_m +
                          std::sqrt(robot.yaw_variance) * normal(generator);
    run.state(1, k + 1) =
        g * run.state(1, k) + (1.0 - g) * 0.5 * (right + left) + std::sqrt(robot.forward_variance) * normal(generator);
  }
  return run;
}

/// A bank of one mode. It is learned as in the chain.
Bank learned(const Recording& recording) {
  const WindowFits fits = fit_windows(recording, {});
  ClusterOptions mixture;
  mixture.selection.components = {1};
  BankOptions bank;
  bank.em.restarts = 0;
  const FeatureCloud cloud = make_features(fits, recording.states, mixture);
  const MixtureResult one = select_mixture(fits, cloud, mixture.selection, 1);
  const Baseline baseline = learn_baseline(recording, fits.global, fits.structure);
  return learn_as_asked(recording, fits, one, bank, baseline.bank.R, FilterOptions(), nullptr).bank;
}

/// Errors divided by the stated standard errors.
using Deviations = std::array<double, names.size()>;

Deviations deviations(int seed) {
  std::mt19937_64 generator(static_cast<std::uint64_t>(seed));
  const Robot robot(generator);
  Recording recording;
  recording.states = {{"wz", "rad/s"}, {"vx", "m/s"}};
  recording.inputs = {{"left", "m/s"}, {"right", "m/s"}};
  for (int i = 0; i < 4; ++i) {
    recording.runs.push_back(drive(robot, 300, generator));
    recording.runs.back().run = fmt::format("{:02}", i);
  }
  ExportedBank exported = as_exported(learned(recording));
  exported.measurements = recording.states;
  exported.recorded_inputs = recording.inputs;
  const RobotBank learned_robot{exported.bank, exported.measurements, exported.recorded_inputs, exported.input_lag_s};
  const RobotNumbers said = robot_numbers(learned_robot, 0, robot_channels(learned_robot), {});
  const Mode& mode = exported.bank.modes[0];
  const double dt_s = exported.bank.dt_s;
  const std::array<Estimate, names.size()> estimates{said.separation_m,
                                                     said.left_multiplier,
                                                     said.right_multiplier,
                                                     said.yaw_delay_s,
                                                     said.forward_delay_s,
                                                     Estimate{mode.Q(0, 0) / dt_s, mode.Q_standard_error(0, 0) / dt_s},
                                                     Estimate{mode.Q(1, 1) / dt_s, mode.Q_standard_error(1, 1) / dt_s}};
  Deviations errors{};
  const Truth truth = robot.truth();
  for (std::size_t i = 0; i < names.size(); ++i) errors[i] = (estimates[i].value - truth[i]) / estimates[i].error;
  return errors;
}

long count_inside(const std::vector<Deviations>& errors, std::size_t quantity) {
  return std::count_if(errors.begin(), errors.end(),
                       [&](const Deviations& seed) { return std::abs(seed[quantity]) <= 2.0; });
}

/// Prints one line per seed. Many seeds take long, so several processes share them, and their lines can be merged.
void print_row(int seed, const Deviations& errors) {
  fmt::print("seed {}: {:.3f}\n", seed, fmt::join(errors, " "));
  std::fflush(stdout);
}

void print_counts(const std::vector<Deviations>& errors) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    double sum = 0.0, squares = 0.0;
    for (const Deviations& seed : errors) {
      sum += seed[i];
      squares += seed[i] * seed[i];
    }
    const double seeds = static_cast<double>(errors.size());
    fmt::print("{}: {} of {} within two standard errors; errors in stated ones: mean {:.3f}, rms {:.3f}\n", names[i],
               count_inside(errors, i), errors.size(), sum / seeds, std::sqrt(squares / seeds));
  }
}

/// The first and the last seed.
std::pair<int, int> seeds_asked(const char* text) {
  int first = 1, last = 50;
  if (text && std::sscanf(text, "%d-%d", &first, &last) == 1) last = std::exchange(first, 1);
  return {first, last};
}

TEST(ExportedRos2, IsWithinTwoStandardErrorsOfRobotsWithoutSlip) {
  const char* asked = std::getenv("MODEBANK_EXPORT_SEEDS");
  const auto [first, last] = seeds_asked(asked);
  const int seeds = last - first + 1;
  std::vector<Deviations> errors(static_cast<std::size_t>(seeds));
  tbb::parallel_for(0, seeds, [&, from = first](int i) {
    errors[static_cast<std::size_t>(i)] = deviations(from + i);
    if (asked) print_row(from + i, errors[static_cast<std::size_t>(i)]);
  });
  print_counts(errors);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const long count = count_inside(errors, i);
    // 93 to 98 % must be within the interval. For fewer seeds, the limits are wider (at the 1 % level).
    const double share = static_cast<double>(count) / seeds, slack = seeds >= 1000 ? 0.0 : 0.57 / std::sqrt(seeds);
    EXPECT_GE(share, 0.93 - slack) << names[i];
    EXPECT_LE(share, 0.98 + slack) << names[i];
  }
}

}  // namespace
}  // namespace modebank::app::test
