#include "tests/support/confidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "ident/base/distributions.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

/// A smaller share of information counts as zero; the region is then that of the prior.
constexpr double least_share = 1e-6;

void check_level(double level) {
  if (!(level > 0.0 && level < 1.0))
    throw std::invalid_argument("confidence level " + std::to_string(level) + " is not between 0 and 1");
}

double region_limit(double parameters, double nu, double level) {
  return std::isinf(nu) ? chi_square_quantile(level, parameters) : parameters * fisher_quantile(level, parameters, nu);
}

}  // namespace

Eigen::VectorXd standard_error(const LocalModel& fit) { return fit.covariance.diagonal().cwiseSqrt(); }

Eigen::VectorXd t_value(const LocalModel& fit) { return fit.theta.cwiseQuotient(standard_error(fit)); }

double region_degrees_of_freedom(const LocalModel& fit) {
  const Index p = fit.theta.size(), q = p / std::max<Index>(fit.noise_variance.size(), 1);
  if (fit.transitions <= q) return std::numeric_limits<double>::infinity();
  const double parameters = static_cast<double>(p);
  const double nu = std::max(1.0, static_cast<double>(fit.transitions - p));
  const double determined = fit.information.sum();
  if (std::isnan(determined) || nu <= 2.0) return nu;
  const double share = std::clamp(determined / parameters, least_share, 1.0);
  return 2.0 + (nu - 2.0) / share;
}

bool ConfidenceRegion::contains(const Eigen::VectorXd& theta) const {
  const Eigen::VectorXd sd = covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd error = (theta - center).cwiseQuotient(sd);
  const Eigen::MatrixXd correlation = sd.cwiseInverse().asDiagonal() * covariance * sd.cwiseInverse().asDiagonal();
  return error.dot(solve_semidefinite(correlation, error)) <= limit;
}

Eigen::MatrixXd ConfidenceRegion::semi_axes() const {
  const SymmetricEigen axes = symmetric_eigen(covariance);
  const Eigen::VectorXd lengths = (limit * axes.values.cwiseMax(0.0)).cwiseSqrt();
  return (axes.vectors * lengths.asDiagonal()).rowwise().reverse();
}

ConfidenceRegion confidence_region(const LocalModel& fit, double level) {
  check_level(level);
  const bool defined = fit.covariance.allFinite() && fit.covariance.size() > 0;
  const double limit = defined
                           ? region_limit(static_cast<double>(fit.theta.size()), region_degrees_of_freedom(fit), level)
                           : not_a_number;
  return {fit.theta, fit.covariance, limit};
}

Eigen::VectorXd interval_half_width(const LocalModel& fit, double level) {
  check_level(level);
  return standard_error(fit) * student_quantile(0.5 * (1.0 + level), region_degrees_of_freedom(fit));
}

}  // namespace modebank
