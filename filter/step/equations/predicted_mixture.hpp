#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/step/equations/filter_step.hpp"
#include "filter/step/interval_mass.hpp"

/// Combination of the modes' predictions: moments of the predicted mixture and the probability transform of a
/// measurement.
namespace modebank {

/// Upper limit of normalised squares.
inline constexpr double largest_nis = 1e300;

/// Moments of the predicted mixture, after `predict`: x = sum c_j x_j, S = sum c_j (S_j + (e_j - e)(e_j - e)').
template <int N, int NY, class State, class Covariance>
void combine(const FilterModel<N, NY>& model, FilterStep<N, NY>& step, State&& x, Covariance&& S) {
  const Eigen::VectorXd& c = step.predicted_probability;
  x.setZero();
  for (std::size_t j = 0; j < step.kalman.size(); ++j)
    x += c(static_cast<Eigen::Index>(j)) * step.kalman[j].predicted.mean;
  S.setZero();
  for (std::size_t j = 0; j < step.kalman.size(); ++j) {
    const double weight = c(static_cast<Eigen::Index>(j));
    step.difference = step.kalman[j].predicted.mean - x;
    small::multiply(step.residual, model.C, step.difference);
    small::add_about_mean(S, weight, step.kalman[j].innovation_covariance, step.residual);
  }
}

/// The innovation of a predicted mixture, and its normalised square. Memory is allocated once.
struct CombinedInnovation {
  Eigen::VectorXd innovation;  ///< n_y, e = y - C x; NaN for missing signals
  double nis = 0.0;            ///< e' S^-1 e of the available signals; NaN if there are none

  explicit CombinedInnovation(Eigen::Index n_y)
      : innovation(n_y), covariance_(n_y, n_y), residual_(n_y), cholesky_(n_y) {}

  void observe(const Eigen::MatrixXd& C, const Eigen::VectorXd& x, const Eigen::MatrixXd& S,
               const Eigen::Ref<const Eigen::VectorXd>& y) {
    small::multiply(innovation, C, x);
    innovation = y - innovation;
    covariance_ = S;
    residual_ = innovation;
    Eigen::Index missing = 0;
    for (Eigen::Index i = 0; i < y.size(); ++i)
      if (is_missing(y(i))) {
        detach(covariance_, i);
        residual_(i) = 0.0;
        innovation(i) = std::numeric_limits<double>::quiet_NaN();
        ++missing;
      }
    cholesky_.factorise(covariance_);
    cholesky_.decorrelate(residual_);
    nis = cholesky_.squared_distance(residual_);
    if (!(nis < largest_nis)) nis = largest_nis;
    if (missing == y.size()) nis = std::numeric_limits<double>::quiet_NaN();
  }

 private:
  Eigen::MatrixXd covariance_;
  Eigen::VectorXd residual_;
  small::Ldl<Eigen::Dynamic> cholesky_;
};

/// A mixture of normal distributions of one signal.
struct NormalMixture {
  Eigen::VectorXd weight, mean, deviation;

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

/// Probability integral transform of the last measurement (Rosenblatt 1952). Component i is the predictive distribution
/// function at y_i, given the earlier signals y_1 .. y_(i-1), which have updated the mixture weights. NaN if y_i is
/// missing. `weights`: workspace, K. Overwrites step.log_likelihood.
template <int N, int NY, class Y, class Pit>
void probability_transform(const Y& y, FilterStep<N, NY>& step, Eigen::VectorXd& weights, Pit&& pit) {
  weights = step.predicted_probability;
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
    pit(i) = sum < 1.0 ? sum : 1.0;  // limits rounding errors of the sum of weights
    if (more) bayes(weights, step.log_likelihood, weights);
  }
}

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

/// Transform of rounded measurements. The predictive distribution function of y_i is computed at both ends of y_i's
/// interval, given the intervals of y_1 .. y_(i-1). Component i lies between the two values. `pit`: mean of the two
/// values. `width`: their difference, 0 for a continuous or missing signal. `signal`(i, j): ModeSignal of mode j.
/// `weights`: the modes' probabilities before the measurement. Overwrites `weights` and `log_likelihood`. Returns the
/// log density of all signals, with the masses of intervals.
template <class Y, class Signal, class Pit, class Width>
double interval_transform(const Eigen::VectorXd& quantum, const Y& y, Signal signal, Eigen::VectorXd& weights,
                          Eigen::VectorXd& log_likelihood, Pit&& pit, Width&& width) {
  double log_density = 0.0;
  width.setZero();
  for (Eigen::Index i = 0; i < pit.size(); ++i) {
    if (is_missing(y(i))) {
      pit(i) = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    const double half = 0.5 * quantum(i);
    double low = 0.0, high = 0.0;
    for (Eigen::Index j = 0; j < weights.size(); ++j) {
      const ModeSignal of_mode = signal(i, j);
      const double e = of_mode.e, deviation = of_mode.unrounded_deviation(quantum(i));
      low += weights(j) * normal_cdf((e - half) / deviation);
      high += weights(j) * normal_cdf((e + half) / deviation);
      log_likelihood(j) = of_mode.log_density(quantum(i));
    }
    high = std::min(high, 1.0);
    low = std::min(low, high);
    pit(i) = 0.5 * (low + high);
    width(i) = high - low;
    log_density += bayes(weights, log_likelihood, weights);
  }
  return log_density;
}

/// For a FilterStep by the equations. Call after the update with y.
template <int N, int NY, class Y, class Pit, class Width>
double interval_transform(const FilterModel<N, NY>& model, const Y& y, FilterStep<N, NY>& step,
                          Eigen::VectorXd& weights, Pit&& pit, Width&& width) {
  weights = step.predicted_probability;
  return interval_transform(
      model.quantum, y,
      [&](Eigen::Index i, Eigen::Index j) {
        const KalmanStep<N, NY>& kalman = step.kalman[static_cast<std::size_t>(j)];
        return ModeSignal{kalman.decorrelated(i), kalman.cholesky.D(i)};
      },
      weights, step.log_likelihood, pit, width);
}

}  // namespace modebank
