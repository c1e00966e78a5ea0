#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <string>
#include <vector>

#include "filter/step/bank.hpp"
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
  std::vector<Mode> modes;  ///< K
  Eigen::Matrix<double, NY, N> C;
  Eigen::Matrix<double, NY, NY> R;
  Eigen::VectorXd quantum;  ///< n_y, for scores; empty if no signal is rounded
  TransitionMatrix transition;
  TransitionLogit transition_logit;
  Eigen::VectorXd initial_probability;                  ///< K
  Eigen::Matrix<double, N, Eigen::Dynamic> start_gain;  ///< x[0] = start_gain y[0]; with lags, y[0] stands for all
                                                        ///< samples of z
  Eigen::Matrix<double, N, N> start_covariance;         ///< P[0]
  MotionTerms terms;                                    ///< nonlinear terms; empty if there are none
  NoiseFactor noise_factor;                             ///< factor on every mode's Q; empty without a factor

  /// Number of rows of F that are not shifts of older samples: the measured states if there are lags, else all n rows.
  Eigen::Index full_rows;
  /// Number of leading columns of C outside which all entries are zero.
  Eigen::Index seen_columns;
  /// Whether covariances are zero: a measurement determines the newest state exactly, and the other rows are its lags.
  bool exact;

  /// Requires check_sizes(bank). Throws std::invalid_argument for FilterVariant::kf with several modes.
  FilterModel(const Bank& bank, const FilterOptions& options)
      : structure(bank.structure),
        variant(options.variant),
        C(bank.C),
        R(bank.recording_noise()),
        quantum(bank.is_quantised() ? bank.quantum : Eigen::VectorXd()),
        transition(bank.transition),
        transition_logit(bank.transition_logit),
        initial_probability(bank.initial_probability),
        terms(bank.terms),
        noise_factor(bank.noise_factor) {
    if (variant == FilterVariant::kf && bank.mode_count() != 1)
      throw std::invalid_argument("a Kalman filter (kf) needs a bank of one mode; this one has " +
                                  std::to_string(bank.mode_count()));
    if (variant == FilterVariant::salvi2025 && !transition_logit.empty())
      throw std::invalid_argument(
          "the paper's equations (salvi2025) do not support switching by state and input; use imm");
    if (variant == FilterVariant::salvi2025 && !noise_factor.empty())
      throw std::invalid_argument(
          "the paper's equations (salvi2025) need constant noise; the noise of this bank depends on state and input");
    for (const modebank::Mode& mode : bank.modes) {
      modes.push_back({mode.model.A, mode.model.full_form(), mode.model.B, mode.model.c, mode.Q, mode.bend});
    }
    full_rows = rows_without_shifts();
    seen_columns = C.cols();
    while (seen_columns > 1 && (C.col(seen_columns - 1).array() == 0.0).all()) --seen_columns;
    exact = structure.state_lags > 1 && variant != FilterVariant::salvi2025 && R.isZero(0.0) &&
            seen_columns == C.rows() && C.leftCols(seen_columns).isIdentity(0.0);
    const StartMoments start = start_moments(bank);
    start_gain = start.gain;
    start_covariance = start.covariance;
  }

  Eigen::Index mode_count() const { return static_cast<Eigen::Index>(modes.size()); }

 private:
  /// A bank from another program may have lags whose rows are not shifts.
  Eigen::Index rows_without_shifts() const {
    const Eigen::Index n = structure.dimension();
    for (const Mode& mode : modes)
      for (Eigen::Index i = structure.states; i < n; ++i)
        if (mode.F.row(i) != Eigen::RowVectorXd::Unit(n, i - structure.states)) return n;
    return structure.states;
  }
};

/// Calls f.template operator()<N, NY>(), with fixed sizes if these are faster. This is the only place where run-time
/// sizes become compile-time sizes.
template <class F>
auto with_sizes(Eigen::Index states, Eigen::Index measurements, F&& f) {
  if (states == 1 && measurements == 1) return f.template operator()<1, 1>();
  if (states == 2 && measurements == 1) return f.template operator()<2, 1>();
  if (states == 2 && measurements == 2) return f.template operator()<2, 2>();
  if (states == 3 && measurements == 1) return f.template operator()<3, 1>();
  if (states == 3 && measurements == 3) return f.template operator()<3, 3>();
  return f.template operator()<Eigen::Dynamic, Eigen::Dynamic>();
}

}  // namespace modebank
