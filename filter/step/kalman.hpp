#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "filter/step/bank.hpp"
#include "filter/step/gaussian.hpp"
#include "ident/base/log_two_pi.hpp"
#include "ident/model/linear_model.hpp"
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

/// Replaces signal i of a covariance by a signal of variance one without correlation.
template <class Matrix>
void detach(Matrix& S, Eigen::Index i) {
  S.row(i).setZero();
  S.col(i).setZero();
  S(i, i) = 1.0;
}

/// A sensor with missing signals. The rows of C and R for a missing signal become those of a signal that is always
/// zero, has variance one and no correlation, and is measured as zero. Gains, NIS and the other signals' densities are
/// then exactly those of the available signals. For each missing signal, the log density is too small by log(2 pi) / 2.
template <int N, int NY>
struct PartialSensor {
  Eigen::Matrix<double, NY, N> C;
  Eigen::Matrix<double, NY, NY> R;
  Eigen::Matrix<double, NY, 1> y;
  static constexpr bool exact = false;
  Eigen::Index seen_columns;  ///< leading columns of C that contain all nonzero entries (FilterModel)
  Eigen::Index missing = 0;   ///< number of missing signals

  PartialSensor(Eigen::Index n, Eigen::Index n_y) : C(n_y, n), R(n_y, n_y), y(n_y), seen_columns(n) {}

  template <class Sensor, class Y>
  void assign(const Sensor& whole, const Y& measured) {
    C = whole.C;
    R = whole.R;
    y = measured;
    seen_columns = whole.seen_columns;
    missing = 0;
    for (Eigen::Index i = 0; i < y.size(); ++i)
      if (is_missing(measured(i))) {
        C.row(i).setZero();
        detach(R, i);
        y(i) = 0.0;
        ++missing;
      }
  }
};

/// One mode's Kalman step with its workspace, sized once. Call in this order: `predict`, `expect`, `observe`,
/// `correct`.
template <int N, int NY>
struct KalmanStep {
  Gaussian<N> predicted;                                ///< x, P before the measurement
  Eigen::Matrix<double, NY, 1> innovation;              ///< e = y - C x
  Eigen::Matrix<double, NY, 1> decorrelated;            ///< L^-1 e; its variance is cholesky.D
  Eigen::Matrix<double, NY, NY> innovation_covariance;  ///< S = C P C' + R
  small::Ldl<NY> cholesky;                              ///< factor of S; a singular S is regularised
  double log_density = 0.0;                             ///< log N(e; 0, S)

  KalmanStep(Eigen::Index n, Eigen::Index n_y, Eigen::Index regressors)
      : predicted(n),
        innovation(n_y),
        decorrelated(n_y),
        innovation_covariance(n_y, n_y),
        cholesky(n_y),
        NN_(n, n),
        gain_(n, n_y),
        PCt_(n, n_y),
        closed_loop_(n, n),
        NY_(n, n_y),
        phi_(regressors) {}

  /// x = x + A x + B u + c, P = F P F' + noise_factor Q. If there are terms g, g is added to x, and F includes the
  /// derivative of g at the mean. This is an extended Kalman filter, which is exact for P = 0.
  template <class U>
  void predict(const Gaussian<N>& from, const FilterModel<N, NY>& model, const typename FilterModel<N, NY>::Mode& mode,
               const U& u, double noise_factor) {
    propagate(mode.A.topRows(model.full_rows), mode.B, mode.c, from.mean, u, predicted.mean);
    for (Eigen::Index i = model.full_rows; i < predicted.mean.size(); ++i)
      predicted.mean(i) = from.mean(i - model.full_rows);
    const auto& F = model.terms.empty() ? mode.F : bend(model, mode, from.mean, u);
    predicted.covariance = noise_factor * mode.Q;
    known_before_ = from.known;
    if (!from.known) add_propagated(F, from.covariance, all_or(model.full_rows));
    make_usable(predicted);
  }
  /// Predicts the measurement: S and its factor. Here and in the functions below, `sensor` has C and R. `sensor` is the
  /// model, or its part for the available signals.
  template <class Sensor>
  void expect(const Sensor& sensor) {
    const Eigen::Index seen = all_or(sensor.seen_columns);
    small::multiply(PCt_, predicted.covariance.template leftCols<N>(seen),
                    sensor.C.template leftCols<N>(seen).transpose());
    innovation_covariance = sensor.R;
    small::add_symmetric_product(innovation_covariance, sensor.C, PCt_.transpose());
    cholesky.factorise(innovation_covariance);
  }
  /// Computes the innovation e and its log density.
  template <class Sensor, class Y>
  void observe(const Sensor& sensor, const Y& y) {
    small::multiply(innovation, sensor.C, predicted.mean);
    innovation = y - innovation;
    decorrelated = innovation;
    log_density = log_normal(decorrelated);
  }
  /// State after the measurement, covariance in Joseph's form.
  template <class Sensor, class Y>
  void correct(const Sensor& sensor, const Y& y, Gaussian<N>& posterior) {
    posterior.known = sensor.exact && known_before_;
    if (posterior.known) {
      posterior.mean = predicted.mean;
      posterior.mean.head(sensor.seen_columns) = y;
      posterior.covariance.setZero();
      return;
    }
    for (Eigen::Index i = 0; i < gain_.rows(); ++i) {  // row i of K = P C' S^-1; S is symmetric
      gain_.row(i) = PCt_.row(i);
      cholesky.solve(gain_.row(i));
    }
    small::multiply(posterior.mean, gain_, innovation);
    posterior.mean += predicted.mean;
    small::multiply(closed_loop_, gain_, sensor.C);
    closed_loop_ = -closed_loop_;
    closed_loop_.diagonal().array() += 1.0;
    take_closed_loop(all_or(sensor.seen_columns), posterior.covariance);
    small::multiply(NY_, gain_, sensor.R);
    small::add_symmetric_product(posterior.covariance, NY_, gain_);
    if (!is_finite(posterior)) posterior = predicted;  // a correction that overflows is ignored
    bound_variances(predicted, posterior);
    if (!sensor.exact) return;
    // Copies the rows that the sensor measures. A correction would add rounding errors.
    posterior.mean.head(sensor.seen_columns) = y;
    posterior.covariance.topRows(sensor.seen_columns).setZero();
    posterior.covariance.leftCols(sensor.seen_columns).setZero();
    posterior.known = posterior.covariance.isZero(0.0);
  }
  /// log N(residual; 0, S) for any residual. `residual` is decorrelated in place.
  template <class Vector>
  double log_normal(Vector& residual) const {
    cholesky.decorrelate(residual);
    return measured_density(-0.5 * (static_cast<double>(residual.size()) * log_two_pi + cholesky.log_determinant() +
                                    cholesky.squared_distance(residual)));
  }

 private:
  Eigen::Matrix<double, N, N> NN_;
  Eigen::Matrix<double, N, NY> gain_, PCt_;
  Eigen::Matrix<double, N, N> closed_loop_;
  Eigen::Matrix<double, N, NY> NY_;
  Eigen::VectorXd phi_;
  TermValues terms_;
  Eigen::Matrix<double, N, N> bent_F_;

  bool known_before_ = false;  ///< Gaussian::known of the start of the prediction

  /// Fixed sizes take all rows or columns, so that loops have constant lengths.
  static constexpr Eigen::Index all_or(Eigen::Index count) { return N == Eigen::Dynamic ? count : N; }
  /// Adds F P F' to the predicted covariance. The rows of F after the first `full` shift older samples.
  void add_propagated(const Eigen::Matrix<double, N, N>& F, const Eigen::Matrix<double, N, N>& P, Eigen::Index full) {
    const auto F1 = F.template topRows<N>(full);
    auto F1P = NN_.template topRows<N>(full);
    small::multiply(F1P, F1, P);
    small::add_symmetric_product(predicted.covariance.template topLeftCorner<N, N>(full, full), F1P, F1);
    if (const Eigen::Index older = P.rows() - full; older > 0) {
      predicted.covariance.topRightCorner(full, older) += F1P.leftCols(older);
      predicted.covariance.bottomLeftCorner(older, full) += F1P.leftCols(older).transpose();
      predicted.covariance.bottomRightCorner(older, older) += P.topLeftCorner(older, older);
    }
  }
  /// (I - K C) P (I - K C)'. The closed loop differs from the identity only in its first `seen` columns.
  void take_closed_loop(Eigen::Index seen, Eigen::Matrix<double, N, N>& result) {
    const auto changed = closed_loop_.template leftCols<N>(seen);
    small::multiply(NN_, changed, predicted.covariance.template topRows<N>(seen));
    result.setZero();
    if (const Eigen::Index rest = NN_.rows() - seen; rest > 0) {
      NN_.bottomRows(rest) += predicted.covariance.bottomRows(rest);
      result.bottomRightCorner(rest, rest) = NN_.bottomRightCorner(rest, rest);
    }
    small::add_symmetric_product(result, NN_.template leftCols<N>(seen), changed);
  }
  /// Adds the terms to the predicted mean, and their derivatives to F.
  template <class U>
  const Eigen::Matrix<double, N, N>& bend(const FilterModel<N, NY>& model,
                                          const typename FilterModel<N, NY>::Mode& mode,
                                          const Eigen::Matrix<double, N, 1>& x, const U& u) {
    fill_regressor(model.structure, x, u, phi_);
    terms_.evaluate(model.terms, phi_);
    bent_F_ = mode.F;
    const Eigen::MatrixXd& slope = terms_.slope();
    for (Eigen::Index a = 0; a < mode.bend.rows(); ++a) {
      predicted.mean(a) += mode.bend.row(a).dot(terms_.value());
      for (Eigen::Index i = 0; i < bent_F_.cols(); ++i) bent_F_(a, i) += mode.bend.row(a).dot(slope.col(i));
    }
    return bent_F_;
  }
};

}  // namespace modebank
