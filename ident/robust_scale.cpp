#include "ident/robust_scale.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ident/not_a_number.hpp"

namespace modebank {

namespace {
constexpr double mad_to_sd = 1.4826;
constexpr double floor_share = 1e-3;
constexpr double least_scale = 1e-150;  // its square is still a normal number
}  // namespace

double median(Eigen::VectorXd values) {
  if (values.size() == 0) return not_a_number;
  double* const middle = values.data() + values.size() / 2;
  std::nth_element(values.data(), middle, values.data() + values.size());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.data(), middle));
}

double normalised_mad(const Eigen::VectorXd& values) {
  return mad_to_sd * median((values.array() - median(values)).abs());
}

Eigen::VectorXd robust_scale(const Transitions& transitions, const Decomposition& decomposition) {
  const Index N = transitions.count(), rank = decomposition.rank(), n = transitions.increments.cols();
  if (N <= rank) return Eigen::VectorXd::Constant(n, not_a_number);
  const Eigen::MatrixXd r = residuals(decomposition, transitions.increments);
  Eigen::VectorXd scale(n);
  for (Index i = 0; i < n; ++i) scale(i) = normalised_mad(r.col(i));
  return scale * std::sqrt(static_cast<double>(N) / static_cast<double>(N - rank));
}

Eigen::VectorXd scale_floor(const Transitions& training, const Eigen::VectorXd& global_noise_variance) {
  Eigen::VectorXd floor = floor_share * global_noise_variance.cwiseSqrt();
  for (Index i = 0; i < floor.size(); ++i) {
    const double rms = training.regressors.col(i).stableNorm() / std::sqrt(static_cast<double>(training.count()));
    floor(i) = std::max(floor(i), std::numeric_limits<double>::epsilon() * rms);
    floor(i) = floor(i) > 0.0 ? std::max(floor(i), least_scale) : 1.0;
  }
  return floor;
}

}  // namespace modebank
