#include "ident/fit/prior.hpp"

#include <cmath>
#include <vector>

#include "ident/fit/scale.hpp"
#include "modebank/base/eigen.hpp"

namespace modebank {

namespace {

constexpr double widening = 3.0;

double sample_sd(const Eigen::VectorXd& values) {
  if (values.size() < 2) return 0.0;
  const double square_sum = (values.array() - values.mean()).square().sum();
  return std::sqrt(square_sum / static_cast<double>(values.size() - 1));
}

Eigen::MatrixXd finite_columns(const Eigen::MatrixXd& all) {
  std::vector<Index> finite;
  for (Index i = 0; i < all.cols(); ++i)
    if (all.col(i).allFinite()) finite.push_back(i);
  return all(Eigen::all, finite);
}

bool usable(double sd) { return std::isfinite(sd) && sd > 0.0; }

}  // namespace

Eigen::VectorXd default_prior_sd(const Eigen::MatrixXd& all, const GlobalModel& global, Index length) {
  const Eigen::MatrixXd parameters = finite_columns(all);
  const double windows_worth = static_cast<double>(global.transitions) / static_cast<double>(length);
  Eigen::VectorXd sd(global.theta.size());
  for (Index j = 0; j < sd.size(); ++j) {
    double window_sd = parameters.cols() > 0 ? normalised_mad(parameters.row(j).transpose()) : 0.0;
    if (!usable(window_sd) && parameters.cols() > 0) window_sd = sample_sd(parameters.row(j).transpose());
    if (!usable(window_sd)) window_sd = std::sqrt(global.covariance(j, j) * windows_worth);
    sd(j) = usable(window_sd) ? widening * window_sd : 1.0;
  }
  return sd;
}

Eigen::VectorXd make_prior_sd(const FitOptions& options, const GlobalModel& global,
                              const std::function<Eigen::MatrixXd()>& unregularised) {
  const std::vector<double>& given = options.prior_sd;
  const Index p = global.theta.size();
  if (std::ssize(given) == p) return view(given);
  if (given.size() == 1) return Eigen::VectorXd::Constant(p, given.front());
  return default_prior_sd(unregularised(), global, options.length);
}

}  // namespace modebank
