#pragma once

#include <Eigen/Core>
#include <cmath>
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
  double nis = 0.0;                                     ///< e' S^-1 e
  small::Cholesky<NY> cholesky;                         ///< of S

  CombinedPrediction(Eigen::Index n, Eigen::Index n_y)
      : state(n), innovation(n_y), innovation_covariance(n_y, n_y), cholesky(n_y) {}

  /// x and S after `predict`.
  void expect(const FilterModel<N, NY>& model, FilterStep<N, NY>& step) {
    state.setZero();
    for (std::size_t j = 0; j < step.kalman.size(); ++j) state += weight(step, j) * step.kalman[j].predicted.mean;
    innovation_covariance.setZero();
    for (std::size_t j = 0; j < step.kalman.size(); ++j) {
      step.difference = step.kalman[j].predicted.mean - state;
      small::multiply(step.residual, model.C, step.difference);
      small::add_spread(innovation_covariance, weight(step, j), step.kalman[j].innovation_covariance, step.residual);
    }
  }

  /// e and its normalised square after `expect`.
  template <class Y>
  void observe(const FilterModel<N, NY>& model, const Y& y, FilterStep<N, NY>& step) {
    small::multiply(innovation, model.C, state);
    innovation = y - innovation;
    cholesky.factorise(innovation_covariance);
    step.residual = innovation;
    cholesky.decorrelate(step.residual);
    nis = cholesky.squared_distance(step.residual);
    if (!(nis < largest_nis)) nis = largest_nis;
  }

 private:
  static double weight(const FilterStep<N, NY>& step, std::size_t j) {
    return step.predicted_probability(static_cast<Eigen::Index>(j));
  }
};

/// Phi(x), accurate in relative terms far into the lower tail.
inline double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

/// Probability integral transform of the measurement taken in last (Rosenblatt 1952): component i is the predictive
/// distribution function of y_i given y_1 .. y_(i-1), whose mixture weights those components have updated. Overwrites
/// step.log_likelihood; `weights` is workspace of size K.
template <int N, int NY, class Pit>
void probability_transform(FilterStep<N, NY>& step, Eigen::VectorXd& weights, Pit&& pit) {
  weights = step.predicted_probability;
  for (Eigen::Index i = 0; i < pit.size(); ++i) {
    double sum = 0.0;
    for (std::size_t j = 0; j < step.kalman.size(); ++j) {
      const double z = step.kalman[j].decorrelated(i), variance = step.kalman[j].cholesky.D(i);
      sum += weights(static_cast<Eigen::Index>(j)) * normal_cdf(z / std::sqrt(variance));
      step.log_likelihood(static_cast<Eigen::Index>(j)) = -0.5 * (std::log(variance) + z * z / variance);
    }
    pit(i) = sum < 1.0 ? sum : 1.0;  // weights sum to one up to rounding
    if (i + 1 < pit.size()) bayes(weights, step.log_likelihood, weights);
  }
}

}  // namespace modebank
