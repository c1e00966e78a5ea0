#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/step/equations/predicted_mixture.hpp"

/// The interface between free runs and the models that predict (filter/step/forecast.hpp).
namespace modebank {

/// A model's prediction of the measurement some steps ahead: the distribution of each signal, and the joint density.
class Forecast {
 public:
  virtual ~Forecast() = default;
  /// Advances by one model step under these acting inputs.
  virtual void step(const Eigen::Ref<const Eigen::VectorXd>& inputs) = 0;
  /// Call this for each sample, before the queries below. `samples`: number of samples ahead, at least 1.
  virtual void arrive(Eigen::Index /*samples*/) {}

  virtual Eigen::VectorXd mean() const = 0;                ///< n_y
  virtual Eigen::VectorXd standard_deviation() const = 0;  ///< n_y

  /// P(y_i <= y), and its inverse: the y with that probability.
  virtual double probability(Eigen::Index i, double y) const = 0;
  virtual double quantile(Eigen::Index i, double probability) const = 0;
  /// Joint log density of all signals [nats].
  virtual double log_density(const Eigen::Ref<const Eigen::VectorXd>& y) = 0;
  virtual Eigen::VectorXd mode_probability() const = 0;  ///< K

 protected:
  Forecast() = default;
  Forecast(const Forecast&) = default;
  Forecast& operator=(const Forecast&) = default;
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

}  // namespace modebank
