#pragma once

#include <cmath>

#include "ident/lag/choice.hpp"
#include "tests/ident/ident_test_support.hpp"

namespace modebank::test {

/// First-order response to held commands that act late: tau x' = b'u(t - lag) - x, in exact steps of a millisecond,
/// measured with noise. Commands change every `hold_s` on average and are quantised.
struct DelayedSystem {
  double time_constant_s = 0.2;
  double lag_s = 0.0;
  double duration_s = 60.0;
  double input_rate_hz = 6.5, state_rate_hz = 100.0;
  double noise_sd = 0.01;
  double quantum = 1.0 / 127.0;
  double hold_s = 1.5;
  Eigen::Vector2d gain{-0.6, 0.6};
};

inline RunPair simulate_delayed(const DelayedSystem& system, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  boost::random::uniform_real_distribution<double> uniform(-0.5, 0.5);
  RunPair run;
  run.run = "00";
  const auto inputs = static_cast<Index>(system.duration_s * system.input_rate_hz);
  run.inputs.time_s = Eigen::VectorXd::LinSpaced(inputs, 0.0, static_cast<double>(inputs - 1) / system.input_rate_hz);
  run.inputs.values.resize(2, inputs);
  Eigen::Vector2d command(0.0, 0.0);
  for (Index k = 0; k < inputs; ++k) {
    if (uniform(generator) + 0.5 < 1.0 / (system.hold_s * system.input_rate_hz))
      for (Index i = 0; i < 2; ++i) command(i) = system.quantum * std::round(uniform(generator) / system.quantum);
    run.inputs.values.col(k) = command;
  }
  constexpr int steps_per_s = 1000;
  const int every = static_cast<int>(std::lround(steps_per_s / system.state_rate_hz));
  const auto states = static_cast<Index>(system.duration_s * system.state_rate_hz);
  run.states.time_s.resize(states);
  run.states.values.resize(1, states);
  double x = 0.0;
  for (Index k = 0; k < states; ++k)
    for (int j = 0; j < every; ++j) {
      const double t = static_cast<double>(k * every + j) / steps_per_s;
      if (j == 0) {
        run.states.time_s(k) = t;
        run.states.values(0, k) = x + system.noise_sd * normal(generator);
      }
      const double acting = t - system.lag_s;
      const auto sample =
          std::clamp<Index>(static_cast<Index>(std::floor(acting * system.input_rate_hz + 1e-9)), 0, inputs - 1);
      const double target = acting < 0.0 ? 0.0 : system.gain.dot(run.inputs.values.col(sample));
      x = system.time_constant_s > 0.0 ? target + std::exp(-1.0 / (steps_per_s * system.time_constant_s)) * (x - target)
                                       : target;
    }
  return run;
}

}  // namespace modebank::test
