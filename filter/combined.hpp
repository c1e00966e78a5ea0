#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "filter/filter_step.hpp"

/// What the modes say together: moments of the predicted mixture and the probability transform of a measurement.
namespace modebank {

/// Larger normalised squares are not told apart.
inline constexpr double largest_nis = 1e300;

/// Moments of the predicted mixture: x = sum c_j x_j, S = sum c_j (S_j + (e_j - e)(e_j - e)').
template <int N, int NY>
struct CombinedPrediction {
  Eigen::Matrix<double, N, 1> state;                    ///< x
  Eigen::Matrix<double, NY, 1> innovation;              ///< e = y - C x
  Eigen::Matrix<double, NY, NY> innovation_covariance;  ///< S
  double nis = 0.0;                                     ///< e' S^-1 e, of the signals that are there
  double spread_share = 0.0;     ///< trace of the spread of the modes' predictions within S, over trace of S
  small::Cholesky<NY> cholesky;  ///< of S

  CombinedPrediction(Eigen::Index n, Eigen::Index n_y)
      : state(n),
        innovation(n_y),
        innovation_covariance(n_y, n_y),
        cholesky(n_y),
        observed_(n_y, n_y),
        residual_(n_y) {}

  /// x and S after `predict`.
  void expect(const FilterModel<N, NY>& model, FilterStep<N, NY>& step) {
    state.setZero();
    for (std::size_t j = 0; j < step.kalman.size(); ++j) state += weight(step, j) * step.kalman[j].predicted.mean;
    innovation_covariance.setZero();
    double spread = 0.0;
    for (std::size_t j = 0; j < step.kalman.size(); ++j) {
      step.difference = step.kalman[j].predicted.mean - state;
      small::multiply(step.residual, model.C, step.difference);
      small::add_spread(innovation_covariance, weight(step, j), step.kalman[j].innovation_covariance, step.residual);
      for (Eigen::Index i = 0; i < step.residual.size(); ++i)
        spread += weight(step, j) * step.residual(i) * step.residual(i);
    }
    const double total = innovation_covariance.diagonal().sum();
    spread_share = total > 0.0 ? std::min(1.0, spread / total) : 0.0;
  }

  /// e (NaN where a signal is missing) and its normalised square, of state and innovation_covariance as they are; the
  /// square is NaN without any signal.
  template <class Sensor, class Y>
  void observe(const Sensor& C, const Y& y) {
    small::multiply(innovation, C, state);
    innovation = y - innovation;
    observed_ = innovation_covariance;
    residual_ = innovation;
    Eigen::Index missing = 0;
    for (Eigen::Index i = 0; i < y.size(); ++i)
      if (is_missing(y(i))) {
        PartialSensor<N, NY>::detach(observed_, i);
        residual_(i) = 0.0;
        innovation(i) = std::numeric_limits<double>::quiet_NaN();
        ++missing;
      }
    cholesky.factorise(observed_);
    cholesky.decorrelate(residual_);
    nis = cholesky.squared_distance(residual_);
    if (!(nis < largest_nis)) nis = largest_nis;
    if (missing == y.size()) nis = std::numeric_limits<double>::quiet_NaN();
  }

 private:
  Eigen::Matrix<double, NY, NY> observed_;
  Eigen::Matrix<double, NY, 1> residual_;

  static double weight(const FilterStep<N, NY>& step, std::size_t j) {
    return step.hypothesis_probability()(static_cast<Eigen::Index>(j));
  }
};

/// Phi(x), accurate in relative terms far into the lower tail.
inline double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

/// Probability integral transform of the measurement taken in last (Rosenblatt 1952): component i is the predictive
/// distribution function of y_i given y_1 .. y_(i-1), whose mixture weights those components have updated; NaN where
/// y_i is missing. `weights`: workspace, one per hypothesis. Overwrites step.log_likelihood.
template <int N, int NY, class Y, class Pit>
void probability_transform(const Y& y, FilterStep<N, NY>& step, Eigen::VectorXd& weights, Pit&& pit) {
  weights = step.hypothesis_probability();
  for (Eigen::Index i = 0; i < pit.size(); ++i) {
    if (is_missing(y(i))) {
      pit(i) = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    const bool more = i + 1 < pit.size();
    double sum = 0.0;
    for (Eigen::Index j = 0; j < weights.size(); ++j) {
      const KalmanStep<N, NY>& kalman = step.kalman[static_cast<std::size_t>(j)];
      const double z = kalman.decorrelated(i), v = kalman.cholesky.D(i);
      sum += weights(j) * normal_cdf(z / std::sqrt(v));
      if (more) step.log_likelihood(j) = -0.5 * (std::log(v) + z * z / v);
    }
    pit(i) = sum < 1.0 ? sum : 1.0;  // weights sum to one up to rounding
    if (more) bayes(weights, step.log_likelihood, weights);
  }
}

}  // namespace modebank
