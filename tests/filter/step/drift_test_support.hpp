#pragma once

#include <cmath>

#include "tests/filter/drifting_test_support.hpp"
#include "tests/filter/filter_test_support.hpp"

namespace modebank::test {

inline constexpr double law_digits = 1e-12;
inline constexpr double two_routes = 1e-9;  // tolerance for two computations in double precision over a few hundred
                                            // samples

/// K modes of n states, exactly measured.
inline Bank exact_bank(Index n, Index K) {
  Bank bank = test::example_bank(n, 2, K, 0.0);
  bank.dt_s = 1.0;
  return bank;
}

inline Bank drifting(Bank bank, const DriftRates& rates) {
  bank.drift = {rates, Eigen::VectorXd::LinSpaced(bank.structure.regressors(), 0.3, 1.0)};
  return bank;
}

inline Trajectory with_holes(Trajectory run) {
  run.state.col(20).setConstant(std::nan(""));
  run.state(0, 30) = std::nan("");
  run.time_s.tail(run.samples() - 50).array() += 3.0;
  return run;
}

/// A bank with one drifting mode and known variance, with its results for a run.
struct OneMode {
  Bank model;  ///< model with constant running noise
  Bank bank;   ///< bank with the same model, by the general equations
  Trajectory run;
};

inline OneMode one_mode(Index n, Index lags) {
  OneMode one{example_drifting(n, 2, lags), {}, {}};
  one.model.running_noise.lam = 1.0;
  one.model.running_noise.nu = 0.0;
  one.model.drift.rates.q = 1e-2;
  one.bank = fixed(one.model);
  one.bank.drift = one.model.drift;
  one.run = simulate_drifting(one.model, 200, 4);
  return one;
}

}  // namespace modebank::test
