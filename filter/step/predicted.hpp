#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/step/imm.hpp"
#include "filter/step/noise_density.hpp"

/// Combination of the modes' predictions: moments of the predicted mixture and the probability transform of a
/// measurement.
namespace modebank {

/// Moments of the predicted mixture, after `predict`: x = sum c_j x_j, S = sum c_j (S_j + (e_j - e)(e_j - e)').
template <int N, int NY>
void combine(const FilterModel<N, NY>& model, FilterStep<N, NY>& step, Eigen::VectorXd& x, Eigen::MatrixXd& S) {
  const Eigen::VectorXd& c = step.predicted_probability;
  step.mean.setZero();
  for (std::size_t j = 0; j < step.kalman.size(); ++j)
    step.mean += c(static_cast<Eigen::Index>(j)) * step.kalman[j].predicted.mean;
  step.spread.setZero();
  for (std::size_t j = 0; j < step.kalman.size(); ++j) {
    const double weight = c(static_cast<Eigen::Index>(j));
    step.difference = step.kalman[j].predicted.mean - step.mean;
    small::multiply(step.residual, model.C, step.difference);
    small::add_about_mean(step.spread, weight, step.kalman[j].innovation_covariance, step.residual);
  }
  x = step.mean;
  S = step.spread;
}

/// A mixture of normal distributions of one signal.
struct NormalMixture {
  Eigen::VectorXd weight, mean, deviation;

  double mixture_mean() const { return weight.dot(mean); }
  double probability(double y) const {
    double sum = 0.0;
    for (Eigen::Index j = 0; j < weight.size(); ++j) sum += weight(j) * normal_cdf((y - mean(j)) / deviation(j));
    return std::min(sum, 1.0);
  }
  /// Quantile by bisection between the parts' own quantiles. `score`: normal quantile of the probability.
  double quantile(double probability_below, double score) const {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (Eigen::Index j = 0; j < weight.size(); ++j) {
      if (!(weight(j) > negligible_weight)) continue;
      low = std::min(low, mean(j) + score * deviation(j));
      high = std::max(high, mean(j) + score * deviation(j));
    }
    constexpr int most_halvings = 200;
    constexpr double close = 1e-12;
    for (int i = 0; i < most_halvings && high - low > close * (std::abs(low) + std::abs(high)); ++i) {
      const double middle = 0.5 * (low + high);
      (probability(middle) < probability_below ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }

 private:
  static constexpr double negligible_weight = 1e-9;  ///< smallest weight of a part that can matter at the edge of a
                                                     ///< band
};

/// One signal's innovation in one mode, given the previous signals, and its variance.
struct ModeSignal {
  double e = 0.0, s = 0.0;

  /// Standard deviation of the signal before it was rounded. R is at least the variance of rounding, q^2 / 12, so s
  /// contains it; the interval's mass must not count it again.
  double unrounded_deviation(double quantum) const {
    return std::sqrt(std::max(s - quantum * quantum / 12.0, relative_pivot_floor * s));
  }
  /// Log of the mean density of the reading's interval, log(mass / q). As q goes to 0 it tends to the log density, so
  /// scores of coarse and fine readings have one unit.
  double log_density(double quantum) const {
    if (quantum == 0.0) return -0.5 * (log_two_pi + std::log(s) + e * e / s);
    const double deviation = unrounded_deviation(quantum);
    return measured_density(log_normal_mass(e / deviation, quantum / deviation) - std::log(quantum));
  }
};

/// Probability integral transform of the last measurement (Rosenblatt 1952). Component i is the predictive distribution
/// function at y_i, given the earlier signals y_1 .. y_(i-1), which have updated the mixture weights. NaN if y_i is
/// missing. For a rounded signal it lies between the values at both ends of y_i's interval: `pit` is their mean and
/// `width` their difference, else 0. `weights`: workspace, K. Overwrites step.log_likelihood. Returns the log density
/// of all signals with the masses of intervals, if any signal is rounded.
template <int N, int NY, class Y>
double probability_transform(const FilterModel<N, NY>& model, const Y& y, FilterStep<N, NY>& step,
                             Eigen::VectorXd& weights, Eigen::VectorXd& pit, Eigen::VectorXd& width) {
  const bool rounded = model.quantum.size() > 0;
  double log_density = 0.0;
  weights = step.predicted_probability;
  width.setZero();
  for (Eigen::Index i = 0; i < pit.size(); ++i) {
    pit(i) = std::numeric_limits<double>::quiet_NaN();
    if (is_missing(y(i))) continue;
    const bool scores = rounded || i + 1 < pit.size();
    const double quantum = rounded ? model.quantum(i) : 0.0, half = 0.5 * quantum;
    double low = 0.0, high = 0.0;
    for (Eigen::Index j = 0; j < weights.size(); ++j) {
      const KalmanStep<N, NY>& mode = step.kalman[static_cast<std::size_t>(j)];
      const ModeSignal signal{mode.decorrelated(i), mode.cholesky.D(i)};
      const double deviation = signal.unrounded_deviation(quantum);
      high += weights(j) * normal_cdf((signal.e + half) / deviation);
      if (quantum > 0.0) low += weights(j) * normal_cdf((signal.e - half) / deviation);
      if (scores) step.log_likelihood(j) = signal.log_density(quantum);
    }
    high = high < 1.0 ? high : 1.0;  // limits rounding errors of the sum of weights
    low = quantum > 0.0 ? std::min(low, high) : high;
    pit(i) = 0.5 * (low + high);
    width(i) = high - low;
    if (scores) log_density += bayes(weights, step.log_likelihood, weights);
  }
  return log_density;
}

}  // namespace modebank
