#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "filter/step/equations/arithmetic.hpp"
#include "filter/step/equations/bounds.hpp"
#include "filter/step/equations/model.hpp"
#include "filter/step/equations/partial_sensor.hpp"
#include "ident/base/log_two_pi.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// Mean and covariance of a state of size N, fixed or Eigen::Dynamic.
template <int N>
struct Gaussian {
  Eigen::Matrix<double, N, 1> mean;
  Eigen::Matrix<double, N, N> covariance;
  /// Rows from this index on are known: their covariance is zero, and their mean is the same in every mode. The lags of
  /// an exact sensor are known.
  Eigen::Index uncertain;

  explicit Gaussian(Eigen::Index size) : mean(size), covariance(size, size), uncertain(size) {
    mean.setZero();
    covariance.setZero();
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
               const U& u, double noise_factor);
  /// Predicts the measurement: S and its factor. Here and in the functions below, `sensor` has C and R. `sensor` is the
  /// model, or its part for the available signals.
  template <class Sensor>
  void expect(const Sensor& sensor);
  /// Computes the innovation e and its log density.
  template <class Sensor, class Y>
  void observe(const Sensor& sensor, const Y& y);
  /// State after the measurement, covariance in Joseph's form.
  template <class Sensor, class Y>
  void correct(const Sensor& sensor, const Y& y, Gaussian<N>& posterior);
  /// log N(residual; 0, S) for any residual. `residual` is decorrelated in place.
  template <class Vector>
  double log_normal(Vector& residual) const;

 private:
  Eigen::Matrix<double, N, N> NN_;
  Eigen::Matrix<double, N, NY> gain_, PCt_;
  Eigen::Matrix<double, N, N> closed_loop_;
  Eigen::Matrix<double, N, NY> NY_;
  Eigen::VectorXd phi_;
  TermValues terms_;
  Eigen::Matrix<double, N, N> bent_F_;

  /// Copies the rows that an exact sensor measures. A correction would add rounding errors.
  template <class Sensor, class Y>
  static void take_exactly(const Sensor& sensor, const Y& y, Gaussian<N>& posterior);
  /// Adds the terms to the predicted mean, and their derivatives to F.
  template <class U>
  const Eigen::Matrix<double, N, N>& bend(const FilterModel<N, NY>& model,
                                          const typename FilterModel<N, NY>::Mode& mode,
                                          const Eigen::Matrix<double, N, 1>& x, const U& u);
};

/// Repairs a prediction. Diverging values are scaled down. If variances differ by more than double precision, rounding
/// can make a covariance indefinite. The variances then stay, and the correlations are set to zero.
template <int N>
void make_usable(Gaussian<N>& g) {
  double largest = g.covariance(0, 0), least = largest, mean = std::abs(g.mean(0));
  for (Eigen::Index i = 1; i < g.mean.size(); ++i) {
    largest = std::max(largest, g.covariance(i, i));
    least = std::min(least, g.covariance(i, i));
    mean = std::max(mean, std::abs(g.mean(i)));
  }
  if (least < 0.0) {
    for (Eigen::Index j = 0; j < g.mean.size(); ++j)
      for (Eigen::Index i = 0; i < g.mean.size(); ++i) g.covariance(i, j) = i == j ? std::abs(g.covariance(i, j)) : 0.0;
    largest = std::max(largest, -least);
  }
  if (largest > largest_variance) g.covariance *= largest_variance / largest;
  if (mean > largest_mean) g.mean *= largest_mean / mean;
}

/// Bounds the variances after a measurement, because a measurement cannot enlarge them. Rounding can make a variance
/// negative if S is near singular (R = 0 and singular Q). The variances are then kept within the bounds, and the
/// correlations are set to zero.
template <int N>
void bound_variances(const Gaussian<N>& predicted, Gaussian<N>& posterior) {
  if ((posterior.covariance.diagonal().array() >= 0.0).all()) return;
  for (Eigen::Index j = 0; j < posterior.mean.size(); ++j)
    for (Eigen::Index i = 0; i < posterior.mean.size(); ++i)
      posterior.covariance(i, j) =
          i == j ? std::clamp(posterior.covariance(i, i), 0.0, std::max(0.0, predicted.covariance(i, i))) : 0.0;
}

/// Whether every number is finite. Tests the sum of the numbers (terms are far below overflow).
template <int N>
bool is_finite(const Gaussian<N>& g) {
  double sum = 0.0;
  for (Eigen::Index j = 0; j < g.mean.size(); ++j) {
    sum += g.mean(j);
    for (Eigen::Index i = 0; i < g.mean.size(); ++i) sum += g.covariance(i, j);
  }
  return std::isfinite(sum);
}

template <int N, int NY>
template <class U>
void KalmanStep<N, NY>::predict(const Gaussian<N>& from, const FilterModel<N, NY>& model,
                                const typename FilterModel<N, NY>::Mode& mode, const U& u, double noise_factor) {
  propagate(mode.A.topRows(model.full_rows), mode.B, mode.c, from.mean, u, predicted.mean);
  for (Eigen::Index i = model.full_rows; i < predicted.mean.size(); ++i)
    predicted.mean(i) = from.mean(i - model.full_rows);
  const auto& F = model.terms.empty() ? mode.F : bend(model, mode, from.mean, u);
  predicted.covariance = noise_factor * mode.Q;
  predicted.uncertain = std::min(from.mean.size(), from.uncertain + model.full_rows);
  if (from.uncertain > 0) {
    const Eigen::Index full = small::or_all<N>(model.full_rows), inner = small::or_all<N>(from.uncertain);
    small::multiply_shifting(NN_, F, from.covariance, full, inner);
    small::add_symmetric_product_shifting(predicted.covariance, NN_, F, full, inner);
  }
  make_usable(predicted);
}

template <int N, int NY>
template <class U>
const Eigen::Matrix<double, N, N>& KalmanStep<N, NY>::bend(const FilterModel<N, NY>& model,
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

template <int N, int NY>
template <class Sensor>
void KalmanStep<N, NY>::expect(const Sensor& sensor) {
  small::multiply_transposed(PCt_, predicted.covariance, sensor.C, small::or_all<N>(sensor.seen_columns));
  innovation_covariance = sensor.R;
  small::add_symmetric_product(innovation_covariance, sensor.C, PCt_.transpose());
  cholesky.factorise(innovation_covariance);
}

template <int N, int NY>
template <class Sensor, class Y>
void KalmanStep<N, NY>::observe(const Sensor& sensor, const Y& y) {
  small::multiply(innovation, sensor.C, predicted.mean);
  innovation = y - innovation;
  decorrelated = innovation;
  log_density = log_normal(decorrelated);
}

template <int N, int NY>
template <class Vector>
double KalmanStep<N, NY>::log_normal(Vector& residual) const {
  cholesky.decorrelate(residual);
  return measured_density(-0.5 * (static_cast<double>(residual.size()) * log_two_pi + cholesky.log_determinant() +
                                  cholesky.squared_distance(residual)));
}

template <int N, int NY>
template <class Sensor, class Y>
void KalmanStep<N, NY>::correct(const Sensor& sensor, const Y& y, Gaussian<N>& posterior) {
  posterior.uncertain = predicted.uncertain;
  if (sensor.exact && predicted.uncertain <= sensor.seen_columns) {
    posterior.mean = predicted.mean;
    posterior.covariance.setZero();
    posterior.uncertain = 0;
    return take_exactly(sensor, y, posterior);
  }
  for (Eigen::Index i = 0; i < gain_.rows(); ++i) {  // row i of K = P C' S^-1; S is symmetric
    gain_.row(i) = PCt_.row(i);
    cholesky.solve(gain_.row(i));
  }
  small::multiply(posterior.mean, gain_, innovation);
  posterior.mean += predicted.mean;
  small::multiply(closed_loop_, gain_, sensor.C);
  closed_loop_ = -closed_loop_;
  const Eigen::Index seen = small::or_all<N>(sensor.seen_columns);
  closed_loop_.diagonal().array() += 1.0;
  small::multiply_seeing(NN_, closed_loop_, predicted.covariance, seen);
  posterior.covariance.setZero();
  small::add_symmetric_product_seeing(posterior.covariance, NN_, closed_loop_, seen);
  small::multiply(NY_, gain_, sensor.R);
  small::add_symmetric_product(posterior.covariance, NY_, gain_);
  if (!is_finite(posterior)) posterior = predicted;  // a correction that overflows is ignored
  bound_variances(predicted, posterior);
  if (sensor.exact) take_exactly(sensor, y, posterior);
}

template <int N, int NY>
template <class Sensor, class Y>
void KalmanStep<N, NY>::take_exactly(const Sensor& sensor, const Y& y, Gaussian<N>& posterior) {
  const Eigen::Index seen = sensor.seen_columns;
  posterior.mean.head(seen) = y;
  posterior.covariance.topRows(seen).setZero();
  posterior.covariance.leftCols(seen).setZero();
}

}  // namespace modebank
