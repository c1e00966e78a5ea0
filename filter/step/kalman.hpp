#pragma once

#include <Eigen/Core>
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

/// Replaces signal i of a covariance by one of variance one without correlation.
template <class Matrix>
void detach(Matrix& S, Eigen::Index i) {
  S.row(i).setZero();
  S.col(i).setZero();
  S(i, i) = 1.0;
}

/// y = C x + v, v ~ N(0, R), for all signals or for those of a sample with missing ones.
template <int N, int NY>
struct Sensor {
  Eigen::Matrix<double, NY, N> C;
  Eigen::Matrix<double, NY, NY> R;
  /// Number of leading columns of C outside which all entries are zero.
  Eigen::Index seen_columns;
  /// Whether covariances are zero: a measurement determines the newest state exactly, and the other rows are its lags.
  bool exact = false;
  Eigen::Index missing = 0;  ///< number of missing signals

  /// Takes the place of `whole` for a sample with missing signals. They become signals that are always zero, have
  /// variance one and no correlation, and are measured as zero. Gains, NIS and densities are then exactly those of the
  /// available signals, but the log density is too small by log(2 pi) / 2 for each missing one.
  void take_part(const Sensor& whole, Eigen::Matrix<double, NY, 1>& y) {
    C = whole.C;
    R = whole.R;
    exact = false;
    for (Eigen::Index i = 0; i < y.size(); ++i)
      if (is_missing(y(i))) {
        C.row(i).setZero();
        detach(R, i);
        y(i) = 0.0;
      }
  }
};

/// A bank in the layout for stepping: N states and NY measurements, fixed or Eigen::Dynamic.
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

  Bank bank;
  FilterVariant variant;
  std::vector<Mode> modes;  ///< K
  Sensor<N, NY> sensor;
  Eigen::VectorXd quantum;                              ///< n_y, for scores; empty if no signal is rounded
  Eigen::Matrix<double, N, Eigen::Dynamic> start_gain;  ///< x[0] = start_gain y[0] (start_moments)
  Eigen::Matrix<double, N, N> start_covariance;         ///< P[0]
  /// Number of rows of F that are not shifts of older samples: the measured states if there are lags, else all n rows.
  Eigen::Index full_rows;

  /// Requires check_sizes(bank). Throws std::invalid_argument for FilterVariant::kf with several modes.
  FilterModel(const Bank& from, const FilterOptions& options)
      : bank(from),
        variant(options.variant),
        sensor{bank.C, bank.recording_noise(), bank.C.cols()},
        quantum(bank.is_quantised() ? bank.quantum : Eigen::VectorXd()) {
    const LinearStructure& structure = bank.structure;
    if (variant == FilterVariant::kf && bank.mode_count() != 1)
      throw std::invalid_argument("a Kalman filter (kf) needs a bank of one mode; this one has " +
                                  std::to_string(bank.mode_count()));
    if (variant == FilterVariant::salvi2025 && !bank.transition_logit.empty())
      throw std::invalid_argument(
          "the paper's equations (salvi2025) do not support switching by state and input; use imm");
    for (const modebank::Mode& mode : bank.modes)
      modes.push_back({mode.model.A, mode.model.full_form(), mode.model.B, mode.model.c, mode.Q, mode.bend});
    const Eigen::Index n = structure.dimension();
    full_rows = structure.states;
    for (const Mode& mode : modes)  // a bank from another program may have lags whose rows are not shifts
      for (Eigen::Index i = structure.states; i < n; ++i)
        if (mode.F.row(i) != Eigen::RowVectorXd::Unit(n, i - structure.states)) full_rows = n;
    Eigen::Index& seen = sensor.seen_columns;
    while (seen > 1 && sensor.C.col(seen - 1).isZero(0.0)) --seen;
    sensor.exact = structure.state_lags > 1 && variant != FilterVariant::salvi2025 && sensor.R.isZero(0.0) &&
                   seen == sensor.C.rows() && sensor.C.leftCols(seen).isIdentity(0.0);
    const StartMoments start = start_moments(bank);
    start_gain = start.gain;
    start_covariance = start.covariance;
  }
};

/// Calls f.template operator()<N, NY>(), with fixed sizes if these are faster.
template <class F>
auto with_sizes(Eigen::Index states, Eigen::Index measurements, F&& f) {
  if (states == 1 && measurements == 1) return f.template operator()<1, 1>();
  if (states == 2 && measurements == 1) return f.template operator()<2, 1>();
  if (states == 2 && measurements == 2) return f.template operator()<2, 2>();
  if (states == 3 && measurements == 1) return f.template operator()<3, 1>();
  if (states == 3 && measurements == 3) return f.template operator()<3, 3>();
  return f.template operator()<Eigen::Dynamic, Eigen::Dynamic>();
}

/// One mode's Kalman step with its workspace, sized once. Call in this order: `predict`, `expect`, `correct`.
template <int N, int NY>
struct KalmanStep {
  using Signals = Eigen::Matrix<double, NY, 1>;
  using Square = Eigen::Matrix<double, N, N>;

  Gaussian<N> predicted;                                ///< x, P before the measurement
  Signals innovation;                                   ///< e = y - C x
  Signals decorrelated;                                 ///< L^-1 e; its variance is cholesky.D
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
        closed_loop_(n, n),
        gain_(n, n_y),
        PCt_(n, n_y),
        NY_(n, n_y),
        phi_(regressors) {}

  /// x = x + A x + B u + c, P = F P F' + Q. Terms g are added to x, and F includes their slope at the mean: an extended
  /// Kalman filter, which is exact for P = 0.
  template <class U>
  void predict(const Gaussian<N>& from, const FilterModel<N, NY>& model, const typename FilterModel<N, NY>::Mode& mode,
               const U& u) {
    propagate(mode.A.topRows(model.full_rows), mode.B, mode.c, from.mean, u, predicted.mean);
    for (Eigen::Index i = model.full_rows; i < predicted.mean.size(); ++i)
      predicted.mean(i) = from.mean(i - model.full_rows);
    const Square& F = model.bank.terms.empty() ? mode.F : bend(model, mode, from.mean, u);
    predicted.covariance = mode.Q;
    known_before_ = from.known;
    if (!from.known) add_propagated(F, from.covariance, all_or(model.full_rows));
    make_usable(predicted);
  }
  /// Predicts the measurement: S and its factor.
  void expect(const Sensor<N, NY>& sensor) {
    const Eigen::Index seen = all_or(sensor.seen_columns);
    small::multiply(PCt_, predicted.covariance.template leftCols<N>(seen),
                    sensor.C.template leftCols<N>(seen).transpose());
    innovation_covariance = sensor.R;
    small::add_symmetric_product(innovation_covariance, sensor.C, PCt_.transpose());
    cholesky.factorise(innovation_covariance);
  }
  /// Computes the innovation e and its log density.
  template <class Y>
  void observe(const Sensor<N, NY>& sensor, const Y& y) {
    small::multiply(innovation, sensor.C, predicted.mean);
    decorrelated = innovation = y - innovation;
    log_density = log_normal(decorrelated);
  }
  /// State after the observed measurement, covariance in Joseph's form.
  void correct(const Sensor<N, NY>& sensor, const Signals& y, Gaussian<N>& posterior) {
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
    // A correction that overflows is ignored. The sum of the numbers tells, as terms are far below overflow.
    if (!std::isfinite(posterior.mean.sum() + posterior.covariance.sum())) posterior = predicted;
    bound_variances(predicted, posterior);
    if (!sensor.exact) return;
    // Copies the rows that the sensor measures. A correction would add rounding errors.
    posterior.mean.head(sensor.seen_columns) = y;
    posterior.covariance.topRows(sensor.seen_columns).setZero();
    posterior.covariance.leftCols(sensor.seen_columns).setZero();
    posterior.known = posterior.covariance.isZero(0.0);
  }
  /// log N(residual; 0, S) for any residual. `residual` is decorrelated in place.
  double log_normal(Signals& residual) const {
    cholesky.decorrelate(residual);
    return measured_density(-0.5 * (static_cast<double>(residual.size()) * log_two_pi + cholesky.log_determinant() +
                                    cholesky.squared_distance(residual)));
  }

 private:
  Square NN_, closed_loop_, bent_F_;
  Eigen::Matrix<double, N, NY> gain_, PCt_, NY_;
  Eigen::VectorXd phi_;
  TermValues terms_;
  bool known_before_ = false;  ///< Gaussian::known of the start of the prediction

  /// Fixed sizes take all rows or columns, so that loops have constant lengths.
  static constexpr Eigen::Index all_or(Eigen::Index count) { return N == Eigen::Dynamic ? count : N; }
  /// Adds F P F' to the predicted covariance. The rows of F after the first `full` shift older samples.
  void add_propagated(const Square& F, const Square& P, Eigen::Index full) {
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
  void take_closed_loop(Eigen::Index seen, Square& result) {
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
  const Square& bend(const FilterModel<N, NY>& model, const typename FilterModel<N, NY>::Mode& mode,
                     const Eigen::Matrix<double, N, 1>& x, const U& u) {
    fill_regressor(model.bank.structure, x, u, phi_);
    terms_.evaluate(model.bank.terms, phi_);
    bent_F_ = mode.F;
    predicted.mean.head(mode.bend.rows()).noalias() += mode.bend * terms_.value();
    bent_F_.topRows(mode.bend.rows()).noalias() += mode.bend * terms_.slope().leftCols(bent_F_.cols());
    return bent_F_;
  }
};

}  // namespace modebank
