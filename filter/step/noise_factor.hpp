#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace modebank {

/// One factor on the process noise of every mode. It is a function of the state z and the acting inputs v at the start
/// of a step, limited to 0.2 to 5:
///   f = exp(sum_i weights_i log(|directions_i [z; v]| + 0.1) - offset).
/// With these limits a forecast remains usable if inputs differ from those of the training runs. Without limits, a
/// factor learned on DART lost 54 nats per sample on other runs.
struct NoiseFactor {
  Eigen::MatrixXd directions;  ///< d x (n + m): directions on which the noise depends. Each is scaled so that
                               ///< directions_i [z; v] has a root mean square of 1 on the training runs
  Eigen::VectorXd weights;     ///< d
  double offset = 0.0;         ///< with this offset, log f has mean zero on the training runs

  static constexpr double softening = 0.1, largest = 5.0;

  bool empty() const { return weights.size() == 0; }

  /// log f. NaN if an entry of z or v is not finite. Does not allocate.
  template <class Z, class V>
  double log_at(const Z& z, const V& v) const {
    double sum = -offset;
    for (Eigen::Index i = 0; i < weights.size(); ++i) {
      double along = 0.0;
      for (Eigen::Index j = 0; j < z.size(); ++j) along += directions(i, j) * z(j);
      for (Eigen::Index j = 0; j < v.size(); ++j) along += directions(i, z.size() + j) * v(j);
      sum += weights(i) * std::log(std::abs(along) + softening);
    }
    return std::clamp(sum, -std::log(largest), std::log(largest));
  }
  template <class Z, class V>
  double at(const Z& z, const V& v) const {
    return std::exp(log_at(z, v));
  }
};

}  // namespace modebank
