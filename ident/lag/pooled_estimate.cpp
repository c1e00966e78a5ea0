#include "ident/lag/pooled_estimate.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/not_a_number.hpp"

namespace modebank {

PooledEstimate pool(const Eigen::VectorXd& estimates, const Eigen::VectorXd& errors) {
  PooledEstimate pooled;
  pooled.count = estimates.size();
  pooled.standard_error = not_a_number;
  if (pooled.count == 0) return pooled;
  const Eigen::ArrayXd variance = errors.array().square().max(1e-30);
  const Eigen::ArrayXd fixed = variance.inverse();
  const double fixed_mean = (fixed * estimates.array()).sum() / fixed.sum();
  const double Q = (fixed * (estimates.array() - fixed_mean).square()).sum();
  const double spare = fixed.sum() - fixed.square().sum() / fixed.sum();
  const double between = spare > 0.0 ? std::max(0.0, (Q - static_cast<double>(pooled.count - 1)) / spare) : 0.0;
  const Eigen::ArrayXd weights = (variance + between).inverse();
  pooled.mean = (weights * estimates.array()).sum() / weights.sum();
  pooled.standard_error = 1.0 / std::sqrt(weights.sum());
  pooled.between_sd = std::sqrt(between);
  return pooled;
}

}  // namespace modebank
