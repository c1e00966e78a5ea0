#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/bank.hpp"
#include "filter/evaluate.hpp"
#include "filter/gaussian.hpp"
#include "filter/start_moments.hpp"

namespace modebank {

/// A bank laid out for stepping: N states and NY measurements, fixed or Eigen::Dynamic. Built once, then only read.
template <int N, int NY>
struct FilterModel {
  struct Mode {
    Eigen::Matrix<double, N, N> A;  ///< increment form
    Eigen::Matrix<double, N, N> F;  ///< full form I + A
    Eigen::Matrix<double, N, Eigen::Dynamic> B;
    Eigen::Matrix<double, N, 1> c;
    Eigen::Matrix<double, N, N> Q;
    Eigen::MatrixXd spread;  ///< p x p; empty: the parameters are taken as known
  };

  LinearStructure structure;
  FilterVariant variant;
  bool adaptive;                     ///< whether the noise scale follows the run
  NoiseAdaptation noise_adaptation;  ///< how, if it does
  std::vector<Mode> modes;           ///< K
  Eigen::Matrix<double, NY, N> C;
  Eigen::Matrix<double, NY, NY> R;
  TransitionMatrix transition;
  Eigen::VectorXd initial_probability;                  ///< K
  Eigen::Matrix<double, N, Eigen::Dynamic> start_gain;  ///< x[0] = start_gain y[0], y[0] all of z with lags
  Eigen::Matrix<double, N, N> start_covariance;         ///< P[0]

  /// FilterVariant::kf keeps the first mode alone. Requires check_sizes(bank).
  FilterModel(const Bank& bank, const FilterOptions& options);

  Eigen::Index mode_count() const { return static_cast<Eigen::Index>(modes.size()); }
};

template <int N, int NY>
FilterModel<N, NY>::FilterModel(const Bank& bank, const FilterOptions& options)
    : structure(bank.structure),
      variant(options.variant),
      adaptive(options.noise == FilterNoise::adaptive),
      noise_adaptation(bank.noise_adaptation),
      C(bank.C),
      R(bank.R) {
  const bool single = variant == FilterVariant::kf;
  if (!single) transition = bank.transition;
  initial_probability = single ? Eigen::VectorXd::Ones(1).eval() : bank.initial_probability;
  const std::size_t kept = single ? 1 : bank.modes.size();
  for (std::size_t j = 0; j < kept; ++j) {
    const modebank::Mode& mode = bank.modes[j];
    const bool noisy = options.parameter_noise && mode.spread.size() > 0;
    modes.push_back({mode.model.A, mode.model.full_form(), mode.model.B, mode.model.c, mode.Q,
                     noisy ? mode.spread : Eigen::MatrixXd()});
  }
  const StartMoments start = start_moments(bank);
  start_gain = start.gain;
  start_covariance = start.covariance;
}

/// Calls f.template operator()<N, NY>() with fixed sizes where they are built, Eigen::Dynamic otherwise. The one place
/// where run-time sizes become compile-time sizes.
template <class F>
auto with_sizes(Eigen::Index states, Eigen::Index measurements, F&& f) {
  if (states == 1 && measurements == 1) return f.template operator()<1, 1>();
  if (states == 2 && measurements == 2) return f.template operator()<2, 2>();
  if (states == 3 && measurements == 3) return f.template operator()<3, 3>();
  if (states == 2 && measurements == 1) return f.template operator()<2, 1>();  // one signal and its lags
  if (states == 3 && measurements == 1) return f.template operator()<3, 1>();
  return f.template operator()<Eigen::Dynamic, Eigen::Dynamic>();
}

}  // namespace modebank
