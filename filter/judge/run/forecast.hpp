#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/step/equations/predicted_mixture.hpp"

/// The interface of predictions to free runs, whichever model makes them (filter/step/forecast.hpp).
namespace modebank {

/// The measurement so many model steps ahead as some model predicts it, each signal by itself and all jointly.
class Forecast {
 public:
  virtual ~Forecast() = default;
  /// One model step further under these acting inputs.
  virtual void step(const Eigen::Ref<const Eigen::VectorXd>& inputs) = 0;
  /// Before what is asked below of a sample; `samples`: how many ahead it is, from 1 on.
  virtual void arrive(Eigen::Index /*samples*/) {}

  virtual Eigen::VectorXd mean() const = 0;                ///< n_y
  virtual Eigen::VectorXd standard_deviation() const = 0;  ///< n_y
  /// P(y_i <= y), and the y with that probability.
  virtual double probability(Eigen::Index i, double y) const = 0;
  virtual double quantile(Eigen::Index i, double probability) const = 0;
  /// Of all signals jointly [nats].
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
  /// `score`: the normal quantile of the probability. By bisection between the parts' own quantiles.
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
  static constexpr double negligible_weight = 1e-9;  ///< at the edge of the bands that anyone asks for
};

}  // namespace modebank
