#pragma once

#include <Eigen/Core>
#include <cmath>

namespace modebank {

/// Standard error of the ratio sum(sums) / sum(samples) over G clusters of different sizes; 0 for fewer than two
/// clusters.
inline double clustered_error(const Eigen::VectorXd& sums, const Eigen::VectorXd& samples) {
  const auto G = static_cast<double>(sums.size());
  if (G < 2.0) return 0.0;
  const double N = samples.sum(), mean = sums.sum() / N;
  return std::sqrt(G / (G - 1.0) * (sums - mean * samples).squaredNorm()) / N;
}

}  // namespace modebank
