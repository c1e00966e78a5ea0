#pragma once

#include <Eigen/Core>
#include <span>
#include <type_traits>
#include <vector>

namespace modebank {

/// Mean and covariance of a state of size N, fixed or Eigen::Dynamic.
template <int N>
struct Gaussian {
  Eigen::Matrix<double, N, 1> mean;
  Eigen::Matrix<double, N, N> covariance;

  explicit Gaussian(Eigen::Index size) : mean(size), covariance(size, size) {
    mean.setZero();
    covariance.setZero();
  }
};

/// Mean and covariance of the mixture sum_i weights(i) N(parts[i]) (moment matching). The spread of means is taken
/// about the finished mean. Weights need not sum to one: [S25, eq. 12-13] is the same sum with other weights.
/// (One sum after the other, not one part after the other: sums then live in registers.)
template <int N, class Weights>
void merge(std::type_identity_t<std::span<const Gaussian<N>>> parts, const Weights& weights, Gaussian<N>& merged) {
  const Eigen::Index n = merged.mean.size(), count = static_cast<Eigen::Index>(parts.size());
  const Gaussian<N>* part = parts.data();
  for (Eigen::Index a = 0; a < n; ++a) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < count; ++i) sum += weights(i) * part[i].mean(a);
    merged.mean(a) = sum;
  }
  for (Eigen::Index b = 0; b < n; ++b)
    for (Eigen::Index a = b; a < n; ++a) {
      const double mean_a = merged.mean(a), mean_b = merged.mean(b);
      double sum = 0.0;
      for (Eigen::Index i = 0; i < count; ++i)
        sum += weights(i) * (part[i].covariance(a, b) + (part[i].mean(a) - mean_a) * (part[i].mean(b) - mean_b));
      merged.covariance(a, b) = merged.covariance(b, a) = sum;
    }
}

}  // namespace modebank
