#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <string>
#include <vector>

#include "filter/step/bank.hpp"
#include "filter/step/equations/drift_state.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// A bank in the layout for stepping: N states and NY measurements, fixed or Eigen::Dynamic. Built once, then
/// read-only.
template <int N, int NY>
struct FilterModel {
  struct Mode {
    Eigen::Matrix<double, N, N> A;  ///< increment form
    Eigen::Matrix<double, N, N> F;  ///< full form I + A
    Eigen::Matrix<double, N, Eigen::Dynamic> B;
    Eigen::Matrix<double, N, 1> c;
    Eigen::Matrix<double, N, N> Q;
    Eigen::MatrixXd bend;  ///< measured states x T; empty without terms
  };

  LinearStructure structure;
  FilterVariant variant;
  bool adaptive;                     ///< whether the noise scale adapts to the run
  NoiseAdaptation noise_adaptation;  ///< settings of the adaptation
  std::vector<Mode> modes;           ///< K
  Eigen::Matrix<double, NY, N> C;
  Eigen::Matrix<double, NY, NY> R;
  Eigen::Matrix<double, NY, 1> quantum;  ///< 0: continuous
  bool quantised;                        ///< whether any signal is quantised
  TransitionMatrix transition;
  TransitionLogit transition_logit;
  Eigen::VectorXd initial_probability;                  ///< K
  Eigen::Matrix<double, N, Eigen::Dynamic> start_gain;  ///< x[0] = start_gain y[0]; with lags, y[0] stands for all
                                                        ///< samples of z
  Eigen::Matrix<double, N, N> start_covariance;         ///< P[0]
  DriftModel drift;                                     ///< drift of the modes' coefficients
  MotionTerms terms;                                    ///< nonlinear terms; empty if there are none
  NoiseFactor noise_factor;                             ///< factor on every mode's Q; empty without a factor

  /// Number of rows of F that are not shifts of older samples: the measured states if there are lags, else all n rows.
  Eigen::Index full_rows;
  /// Number of leading columns of C outside which all entries are zero.
  Eigen::Index seen_columns;
  /// Whether covariances are zero: a measurement determines the newest state exactly, and the other rows are its lags.
  bool exact;

  /// Requires check_sizes(bank). Throws std::invalid_argument for FilterVariant::kf with several modes.
  FilterModel(const Bank& bank, const FilterOptions& options);

  Eigen::Index mode_count() const { return static_cast<Eigen::Index>(modes.size()); }
};

/// A bank from another program may have lags whose rows are not shifts.
template <int N, int NY>
Eigen::Index full_rows_of(const FilterModel<N, NY>& model) {
  const Eigen::Index n = model.structure.dimension(), states = model.structure.states;
  for (const auto& mode : model.modes)
    for (Eigen::Index i = states; i < n; ++i)
      if (mode.F.row(i) != Eigen::RowVectorXd::Unit(n, i - states)) return n;
  return states;
}

template <int N, int NY>
FilterModel<N, NY>::FilterModel(const Bank& bank, const FilterOptions& options)
    : structure(bank.structure),
      variant(options.variant),
      adaptive(options.noise == FilterNoise::adaptive),
      noise_adaptation(bank.noise_adaptation),
      C(bank.C),
      R(bank.R),
      quantum(Eigen::VectorXd::Zero(bank.C.rows())),
      quantised(bank.is_quantised()),
      transition(bank.transition),
      transition_logit(bank.transition_logit),
      initial_probability(bank.initial_probability),
      drift(bank),
      terms(bank.terms),
      noise_factor(bank.noise_factor) {
  if (variant == FilterVariant::kf && bank.mode_count() != 1)
    throw std::invalid_argument("a Kalman filter (kf) needs a bank of one mode; this one has " +
                                std::to_string(bank.mode_count()));
  if (variant == FilterVariant::salvi2025 && !transition_logit.empty())
    throw std::invalid_argument(
        "the paper's equations (salvi2025) do not support switching by state and input; use imm");
  if (variant == FilterVariant::salvi2025 && quantised)
    throw std::invalid_argument("the paper's equations (salvi2025) do not support quantised measurements; use imm");
  if (variant == FilterVariant::salvi2025 && !noise_factor.empty())
    throw std::invalid_argument(
        "the paper's equations (salvi2025) need constant noise; the noise of this bank depends on state and input");
  if (quantised) quantum = bank.quantum;
  if (drift.on() && variant != FilterVariant::imm && variant != FilterVariant::kf)
    throw std::invalid_argument("drifting modes need the variant imm or kf, not " + std::string(name_of(variant)));
  for (const modebank::Mode& mode : bank.modes) {
    modes.push_back({mode.model.A, mode.model.full_form(), mode.model.B, mode.model.c, mode.Q, mode.bend});
  }
  full_rows = full_rows_of(*this);
  seen_columns = C.cols();
  while (seen_columns > 1 && (C.col(seen_columns - 1).array() == 0.0).all()) --seen_columns;
  exact = structure.state_lags > 1 && !quantised && !drift.on() && variant != FilterVariant::salvi2025 &&
          R.isZero(0.0) && seen_columns == C.rows() && C.leftCols(seen_columns).isIdentity(0.0);
  const StartMoments start = start_moments(bank);
  start_gain = start.gain;
  start_covariance = start.covariance;
}

/// Calls f.template operator()<N, NY>(), with fixed sizes if these are faster. One state and one signal run three times
/// as fast (K = 9, GPB2: 1.5 us instead of 4.9 us). With two and three states the factor is only 1.7 and 1.5, and the
/// IMM has vector kernels for these sizes. This is the only place where run-time sizes become compile-time sizes.
template <class F>
auto with_sizes(Eigen::Index states, Eigen::Index measurements, F&& f) {
  if (states == 1 && measurements == 1) return f.template operator()<1, 1>();
  return f.template operator()<Eigen::Dynamic, Eigen::Dynamic>();
}

}  // namespace modebank
