#pragma once

#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <random>

#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/switching/regression.hpp"
#include "tests/filter/learn/learn_test_support.hpp"

namespace modebank::test {

inline constexpr double mode_a[] = {-0.5, -0.1}, mode_b[] = {0.4, -0.3}, mode_sd[] = {0.05, 0.1};

/// Log odds of mode 1 after mode i: offset(i) + slope u.
struct LogOdds {
  Eigen::Vector2d offset;
  double slope;
};

/// x+ = x + a_m x + b_m u + w. The mode of a step is drawn from these odds. No input lies within `gap` of `border`.
inline Recording state_dependent_runs(const LogOdds& log_odds, Index runs, Index samples, std::uint64_t seed,
                                      double border = 0.0, double gap = 0.0) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  boost::random::uniform_01<double> uniform;
  Recording recording = empty_recording(1, 1);
  for (Index r = 0; r < runs; ++r) {
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, samples), u(1, samples);
    int mode = 0;
    for (Index k = 0; k < samples; ++k) {
      u(k) = normal(generator);
      if (std::abs(u(k) - border) < gap) u(k) += u(k) > border ? gap : -gap;
      mode = uniform(generator) < 1.0 / (1.0 + std::exp(-log_odds.offset(mode) - log_odds.slope * u(k))) ? 1 : 0;
      if (k + 1 < samples)
        x(k + 1) = x(k) + mode_a[mode] * x(k) + mode_b[mode] * u(k) + mode_sd[mode] * normal(generator);
    }
    add_run(recording, x, u);
  }
  return recording;
}

inline SwitchingRegression true_model(const LogOdds& log_odds) {
  SwitchingRegression model;
  model.theta = Eigen::MatrixXd{{mode_a[0], mode_a[1]}, {mode_b[0], mode_b[1]}};
  model.Q = {Eigen::MatrixXd::Constant(1, 1, mode_sd[0] * mode_sd[0]),
             Eigen::MatrixXd::Constant(1, 1, mode_sd[1] * mode_sd[1])};
  model.transition.resize(2, 2);
  for (Index i = 0; i < 2; ++i) {
    const double p = 1.0 / (1.0 + std::exp(-log_odds.offset(i)));
    model.transition.row(i) << 1.0 - p, p;
  }
  model.initial = Eigen::Vector2d(0.5, 0.5);
  model.logit = {Eigen::MatrixXd{{0.0, -0.5 * log_odds.slope}, {0.0, 0.5 * log_odds.slope}}, Eigen::VectorXd::Zero(2)};
  return model;
}

inline const LogOdds soft{{-2.0, 1.0}, 1.5};

inline Bank bank_of(const Recording& recording, const TrainingTransitions& t, const SwitchingRegression& model) {
  return with_modes(bank_frame(recording, t.structure, Eigen::MatrixXd::Zero(1, 1)), model);
}

}  // namespace modebank::test
