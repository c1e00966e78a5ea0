#include "mixture/features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ident/base/linalg.hpp"
#include "mixture/straddling.hpp"

namespace modebank {

using Eigen::Index;

namespace {

bool wanted(const WindowFits& fits, WindowChoice choice, Index window) {
  if (fits.status(window) == static_cast<int>(FitStatus::failed)) return false;
  const bool full_rank_only =
      choice == WindowChoice::full_rank || (choice == WindowChoice::automatic && fits.prior_sd.size() == 0);
  return !full_rank_only || fits.rank(window) == fits.parameter_count();
}

/// Data with less than this share in what is known of a direction are treated as if they had it, so that a direction of
/// which a window says nothing gets an error of 20 prior variances rather than an infinite one.
constexpr double least_information = 0.05;

/// What the window's data alone say of theta: the posterior without the prior (mean the global model, standard
/// deviations prior_sd), as estimate and covariance. In units of the prior a posterior variance c along an eigenvector
/// is a measurement of variance c / (1 - c), and the posterior's offset from the prior is 1 - c of the measured one.
void take_off_prior(const WindowFits& fits, Eigen::VectorXd& theta, Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd &sd = fits.prior_sd, &mean = fits.global.theta;
  const Eigen::VectorXd inverse = sd.cwiseInverse();
  const auto [values, vectors] = symmetric_eigen(inverse.asDiagonal() * covariance * inverse.asDiagonal());
  const Eigen::ArrayXd known = (1.0 - values.array()).max(least_information);
  const Eigen::VectorXd measured =
      vectors * ((vectors.transpose() * (theta - mean).cwiseQuotient(sd)).array() / known).matrix();
  theta = mean + measured.cwiseProduct(sd);
  const Eigen::VectorXd variance = values.array().max(0.0) / known;
  covariance = sd.asDiagonal() * vectors * variance.asDiagonal() * vectors.transpose() * sd.asDiagonal();
  covariance = (0.5 * (covariance + covariance.transpose())).eval();
}

/// Of the logarithm of a noise variance estimated from what L transitions leave over after `rank` / n parameters.
double log_variance_error(const WindowFits& fits, Index window) {
  const double transitions = static_cast<double>(fits.transitions.size() > 0 ? fits.transitions(window) : fits.length);
  const double unknowns = static_cast<double>(fits.rank(window)) / static_cast<double>(fits.structure.states);
  return 2.0 / std::max(transitions - unknowns, 1.0);
}

}  // namespace

FeatureCloud make_features(const WindowFits& fits, FeatureSet features, WindowChoice choice,
                           const std::vector<Channel>& states, StraddlingWindows straddling, WindowErrors errors) {
  const Index p = fits.parameter_count(), n = fits.structure.states;
  const bool with_noise = features == FeatureSet::parameters_and_noise;
  const bool with_errors = errors == WindowErrors::include;
  if (static_cast<Index>(states.size()) != n)
    throw std::invalid_argument(fmt::format("features of {} states are given {} state names", n, states.size()));
  FeatureCloud cloud;
  cloud.names = fits.parameter_names();
  if (with_noise)
    for (const Channel& state : states) cloud.names.push_back("log_noise_variance_" + state.name);
  const Index F = p + (with_noise ? n : 0);
  Eigen::MatrixXd points(F, fits.count()), covariances(F * F, with_errors ? fits.count() : 0);
  Eigen::VectorXd point(F), theta(p);
  Eigen::MatrixXd error = Eigen::MatrixXd::Zero(F, F), covariance(p, p);
  const std::vector<bool> left_out = straddling != StraddlingWindows::keep
                                         ? straddling_windows(fits)
                                         : std::vector<bool>(static_cast<std::size_t>(fits.count()), false);
  for (Index window = 0; window < fits.count(); ++window) {
    if (!wanted(fits, choice, window) || left_out[static_cast<std::size_t>(window)]) continue;
    theta = fits.parameters.col(window);
    if (with_errors) {
      covariance = Eigen::Map<const Eigen::MatrixXd>(fits.covariance.col(window).data(), p, p);
      if (!covariance.allFinite() || !theta.allFinite()) continue;
      if (fits.prior_sd.size() > 0) take_off_prior(fits, theta, covariance);
      error.topLeftCorner(p, p) = covariance;
      if (with_noise) error.diagonal().tail(n).setConstant(log_variance_error(fits, window));
    }
    point.head(p) = theta;
    if (with_noise) point.tail(n) = fits.noise_variance.col(window).array().log();
    if (!point.allFinite()) continue;
    const Index position = static_cast<Index>(cloud.windows.size());
    points.col(position) = point;
    if (with_errors) covariances.col(position) = error.reshaped();
    cloud.windows.push_back(window);
    cloud.runs.push_back(fits.windows[window].run);
  }
  const Index count = static_cast<Index>(cloud.windows.size());
  points.conservativeResize(F, count);
  cloud.points = std::move(points);
  if (with_errors) {
    covariances.conservativeResize(F * F, count);
    cloud.covariances = std::move(covariances);
  }
  return cloud;
}

FeatureCloud make_features(const WindowFits& fits, const std::vector<Channel>& states, const ClusterOptions& options) {
  return make_features(fits, options.features, options.windows, states, options.straddling,
                       options.error_aware ? WindowErrors::include : WindowErrors::ignore);
}

}  // namespace modebank
