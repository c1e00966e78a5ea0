#include "ident/fit_transitions.hpp"

#include "ident/covariance.hpp"
#include "ident/m_estimate.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

namespace {

/// An inlier keeps at least this share of its least-squares weight.
constexpr double inlier_weight = 0.5;

/// Squares of the residuals summed per state, in units of sigma, each sample with its weight.
Eigen::VectorXd sum_of_squares(const WhitenedProblem& problem, const RobustTerms& terms,
                               const Eigen::VectorXd& weight) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(problem.states);
  for (Index k = 0; k < problem.samples; ++k) sum += weight(k) * terms.sample(k, problem.states).cwiseAbs2();
  return sum;
}

/// Noise variance per state as fit_window states it.
Eigen::VectorXd noise_variance(const WhitenedProblem& problem, const RobustTerms& terms, Index rank,
                               const Estimator& estimator, const NoiseScale& scale) {
  const bool short_window = problem.samples <= estimator.structure.regressors();
  const double divisor = short_window ? static_cast<double>(problem.samples)
                                      : static_cast<double>(problem.samples - rank) * estimator.consistency;
  const Eigen::VectorXd sum =
      sum_of_squares(problem, terms, short_window ? Eigen::VectorXd::Ones(problem.samples).eval() : terms.weight);
  return (sum.array() / divisor * scale.sigma.array().square()).max(scale.floor.array().square());
}

Eigen::VectorXd information(const Eigen::MatrixXd& covariance, const ParameterPrior* prior) {
  if (!prior) return Eigen::VectorXd::Constant(covariance.rows(), not_a_number);
  return 1.0 - covariance.diagonal().array() / prior->sd.array().square();
}

}  // namespace

Estimator make_estimator(const LinearStructure& structure, const FitOptions& options) {
  RobustLoss loss(options.loss, options.loss_scale);
  const double consistency = gaussian_consistency(loss, structure.states);
  return {structure, std::move(loss), consistency, options.covariance, options.max_iterations};
}

LocalModel failed_fit(const LinearStructure& structure) {
  const Index p = structure.parameters();
  LocalModel fit;
  fit.theta = Eigen::VectorXd::Constant(p, not_a_number);
  fit.covariance = Eigen::MatrixXd::Constant(p, p, not_a_number);
  fit.noise_variance = Eigen::VectorXd::Constant(structure.states, not_a_number);
  fit.condition = not_a_number;
  fit.information = fit.theta;
  fit.inlier_fraction = not_a_number;
  fit.status = FitStatus::failed;
  return fit;
}

LocalModel fit_transitions(const Transitions& transitions, const Decomposition& decomposition,
                           const Estimator& estimator, const NoiseScale& scale, const ParameterPrior* prior) {
  const LinearStructure& structure = estimator.structure;
  const WhitenedProblem problem = whiten(transitions, decomposition, scale.sigma, prior);
  const Minimum minimum = minimise(problem, estimator.loss, estimator.max_iterations);
  if (minimum.status == FitStatus::failed) return failed_fit(structure);

  const RobustTerms terms = evaluate(problem, estimator.loss, minimum.z);
  const bool deficient = decomposition.rank() < structure.regressors();
  LocalModel fit;
  fit.theta = problem.theta(minimum.z);
  const Eigen::VectorXd relative_floor = (scale.floor.array() / scale.sigma.array()).square();
  fit.covariance = theta_covariance({problem, terms, structure.regressors(), relative_floor}, estimator.covariance);
  fit.noise_variance = noise_variance(problem, terms, decomposition.rank(), estimator, scale);
  if (!fit.theta.allFinite() || !fit.noise_variance.allFinite()) return failed_fit(structure);  // overflow
  fit.condition = decomposition.condition;
  fit.rank = structure.states * decomposition.rank();
  fit.information = information(fit.covariance, prior);
  fit.inlier_fraction = (terms.weight.array() >= inlier_weight).cast<double>().mean();
  fit.status = deficient ? FitStatus::rank_deficient : minimum.status;
  return fit;
}

Eigen::VectorXd fit_theta(const Transitions& transitions, const Decomposition& decomposition,
                          const Estimator& estimator, const NoiseScale& scale, const ParameterPrior* prior) {
  const WhitenedProblem problem = whiten(transitions, decomposition, scale.sigma, prior);
  const Minimum minimum = minimise(problem, estimator.loss, estimator.max_iterations);
  if (minimum.status == FitStatus::failed)
    return Eigen::VectorXd::Constant(estimator.structure.parameters(), not_a_number);
  return problem.theta(minimum.z);
}

}  // namespace modebank
