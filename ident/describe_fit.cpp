#include "ident/describe_fit.hpp"

#include <cmath>

#include "ident/covariance.hpp"
#include "ident/fit_quality.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

namespace {

/// An inlier keeps at least this share of its least-squares weight.
constexpr double inlier_weight = 0.5;

/// Noise variance per state as fit_window states it.
Eigen::VectorXd noise_variance(const SolvedWindow& s) {
  const auto L = static_cast<double>(s.problem.samples);
  const bool short_window = L <= s.unknowns_per_state;
  const double divisor = short_window ? L : (L - s.rank_per_state) * s.consistency;
  const Eigen::ArrayXXd squares = s.terms.samples(s.problem.states).square();
  const Eigen::VectorXd sum = short_window ? squares.colwise().sum().matrix().transpose().eval()
                                           : (squares.matrix().transpose() * s.terms.weight).eval();
  return (sum.array() / divisor * s.scale.sigma.array().square()).max(s.scale.floor.array().square());
}

Eigen::VectorXd information(const Eigen::MatrixXd& covariance, const ParameterPrior* prior) {
  if (!prior) return Eigen::VectorXd::Constant(covariance.rows(), not_a_number);
  return 1.0 - covariance.diagonal().array() / prior->sd.array().square();
}

}  // namespace

LocalModel describe_fit(const SolvedWindow& s, const Eigen::VectorXd& theta) {
  const Index p = theta.size();
  LocalModel fit;
  fit.theta = theta;
  const Eigen::VectorXd relative_floor = (s.scale.floor.array() / s.scale.sigma.array()).square();
  const auto regressors = static_cast<Index>(std::ceil(s.unknowns_per_state));
  fit.covariance = theta_covariance({s.problem, s.terms, regressors, relative_floor}, s.covariance).topLeftCorner(p, p);
  fit.noise_variance = noise_variance(s);
  if (!fit.theta.allFinite() || !fit.noise_variance.allFinite()) return failed_fit(p, s.problem.states);  // overflow
  fit.information = information(fit.covariance, s.prior);
  fit.inlier_fraction = (s.terms.weight.array() >= inlier_weight).cast<double>().mean();
  fit.r_squared = r_squared(s.transitions, s.problem, s.terms, s.scale.sigma);
  fit.aic = akaike_criterion(s.problem, s.terms, s.loss, s.scale);
  fit.transitions = s.problem.samples;
  return fit;
}

LocalModel failed_fit(Index parameters, Index states) {
  LocalModel fit;
  fit.theta = Eigen::VectorXd::Constant(parameters, not_a_number);
  fit.covariance = Eigen::MatrixXd::Constant(parameters, parameters, not_a_number);
  fit.noise_variance = Eigen::VectorXd::Constant(states, not_a_number);
  fit.condition = not_a_number;
  fit.information = fit.theta;
  fit.inlier_fraction = not_a_number;
  fit.r_squared = fit.noise_variance;
  fit.aic = not_a_number;
  fit.status = FitStatus::failed;
  return fit;
}

}  // namespace modebank
