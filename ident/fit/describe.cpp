#include "ident/fit/describe.hpp"

#include <cmath>

#include "ident/base/not_a_number.hpp"
#include "ident/fit/constants.hpp"
#include "ident/fit/covariance.hpp"

namespace modebank {

namespace {

/// Noise variance of each state, as defined at fit_window.
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

/// Residuals of state i in units of sigma.
auto residuals_of(const WhitenedProblem& problem, const RobustTerms& terms, Index i) {
  using Strided = Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  return Strided(terms.residual.data() + i, problem.samples, Eigen::InnerStride<>(problem.states));
}

}  // namespace

Eigen::VectorXd r_squared(const Transitions& transitions, const WhitenedProblem& problem, const RobustTerms& terms,
                          const Eigen::VectorXd& sigma) {
  const Eigen::ArrayXd omega = terms.weight;
  Eigen::VectorXd result(problem.states);
  for (Index i = 0; i < problem.states; ++i) {
    const Eigen::ArrayXd d = transitions.increments.col(i);
    const double mean = (omega * d).sum() / omega.sum();
    const double total = (omega * (d - mean).square()).sum();
    const double left = (omega * residuals_of(problem, terms, i).array().square()).sum() * sigma(i) * sigma(i);
    result(i) = total > 0.0 ? 1.0 - left / total : not_a_number;
  }
  return result;
}

LocalModel describe_fit(const SolvedWindow& s, const Eigen::VectorXd& theta) {
  const Index p = theta.size();
  LocalModel fit;
  fit.theta = theta;
  const Eigen::VectorXd relative_floor = (s.scale.floor.array() / s.scale.sigma.array()).square();
  const auto regressors = static_cast<Index>(std::ceil(s.unknowns_per_state));
  const CovarianceInput input{s.problem, s.terms, regressors, relative_floor};
  fit.covariance = theta_covariance(input, s.covariance).topLeftCorner(p, p);
  if (s.prior) fit.weighed_information = weighed_information(input, s.covariance);
  fit.noise_variance = noise_variance(s);
  // the fit overflowed
  if (!fit.theta.allFinite() || !fit.noise_variance.allFinite()) return failed_fit(p, s.problem.states);
  fit.information = information(fit.covariance, s.prior);
  fit.inlier_fraction = (s.terms.weight.array() >= inlier_weight).cast<double>().mean();
  fit.r_squared = r_squared(s.transitions, s.problem, s.terms, s.scale.sigma);
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
  fit.status = FitStatus::failed;
  return fit;
}

}  // namespace modebank
