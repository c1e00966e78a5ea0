#include "ident/fit/scale.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ident/base/not_a_number.hpp"
#include "ident/fit/constants.hpp"

namespace modebank {

namespace {
constexpr double floor_share = 1e-3;
constexpr double least_scale = 1e-150;  // the square of this value is still a normal floating-point number
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

Eigen::VectorXd robust_scale(const Eigen::Ref<const Eigen::MatrixXd>& r, double lost) {
  const auto N = static_cast<double>(r.rows());
  if (!(N > lost)) return Eigen::VectorXd::Constant(r.cols(), not_a_number);
  Eigen::VectorXd scale(r.cols());
  for (Index i = 0; i < r.cols(); ++i) scale(i) = normalised_mad(r.col(i));
  return scale * std::sqrt(N / (N - lost));
}

Eigen::VectorXd robust_scale(const Transitions& transitions, const Decomposition& decomposition) {
  return robust_scale(residuals(decomposition, transitions.increments), static_cast<double>(decomposition.rank()));
}

Eigen::VectorXd scale_floor(const Recording& recording, const LinearStructure& structure,
                            const Eigen::VectorXd& global_noise_variance) {
  Eigen::VectorXd floor = floor_share * global_noise_variance.cwiseSqrt();
  Eigen::VectorXd norm = Eigen::VectorXd::Zero(floor.size());  // norm of the values of each state
  Index count = 0;
  for_each_training_block(recording, structure, [&](const Transitions& block) {
    count += block.count();
    for (Index i = 0; i < norm.size(); ++i) norm(i) = std::hypot(norm(i), block.regressors.col(i).stableNorm());
  });
  for (Index i = 0; i < floor.size(); ++i) {
    const double rms = norm(i) / std::sqrt(static_cast<double>(count));
    floor(i) = std::max(floor(i), std::numeric_limits<double>::epsilon() * rms);
    floor(i) = floor(i) > 0.0 ? std::max(floor(i), least_scale) : 1.0;
  }
  return floor;
}

}  // namespace modebank
