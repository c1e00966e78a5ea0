#include "ident/parameter_prior.hpp"

#include <cmath>

#include "ident/robust_scale.hpp"

namespace modebank {

namespace {

constexpr double widening = 3.0;

double sample_sd(const Eigen::VectorXd& values) {
  if (values.size() < 2) return 0.0;
  const double square_sum = (values.array() - values.mean()).square().sum();
  return std::sqrt(square_sum / static_cast<double>(values.size() - 1));
}

bool usable(double sd) { return std::isfinite(sd) && sd > 0.0; }

}  // namespace

Eigen::VectorXd default_prior_sd(const Eigen::MatrixXd& parameters, const GlobalModel& global, Index length) {
  const double windows_worth = static_cast<double>(global.transitions) / static_cast<double>(length);
  Eigen::VectorXd sd(global.theta.size());
  for (Index j = 0; j < sd.size(); ++j) {
    double spread = parameters.cols() > 0 ? normalised_mad(parameters.row(j).transpose()) : 0.0;
    if (!usable(spread) && parameters.cols() > 0) spread = sample_sd(parameters.row(j).transpose());
    if (!usable(spread)) spread = std::sqrt(global.covariance(j, j) * windows_worth);
    sd(j) = usable(spread) ? widening * spread : 1.0;
  }
  return sd;
}

}  // namespace modebank
