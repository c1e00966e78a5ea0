#include "tests/support/confidence.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace modebank::test {

using boost::math::quantile, Eigen::Index;

namespace {

/// A smaller share of information counts as zero; the region is then that of the prior.
constexpr double least_share = 1e-6;

double region_limit(double parameters, double nu, double level) {
  if (std::isinf(nu)) return quantile(boost::math::chi_squared(parameters), level);
  return parameters * quantile(boost::math::fisher_f(parameters, nu), level);
}

}  // namespace

double region_degrees_of_freedom(const FittedTheta& fit) {
  const Index p = fit.theta.size(), q = p / fit.states;
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
  return error.dot(correlation.ldlt().solve(error)) <= limit;
}

ConfidenceRegion confidence_region(const FittedTheta& fit, double level) {
  if (!(level > 0.0 && level < 1.0))
    throw std::invalid_argument("confidence level " + std::to_string(level) + " is not between 0 and 1");
  const bool defined = fit.covariance.allFinite() && fit.covariance.size() > 0;
  const double limit = defined
                           ? region_limit(static_cast<double>(fit.theta.size()), region_degrees_of_freedom(fit), level)
                           : std::numeric_limits<double>::quiet_NaN();
  return {fit.theta, fit.covariance, limit};
}

}  // namespace modebank::test
