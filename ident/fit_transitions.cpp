#include "ident/fit_transitions.hpp"

#include "ident/describe_fit.hpp"
#include "ident/m_estimate.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

Estimator make_estimator(const LinearStructure& structure, const FitOptions& options) {
  RobustLoss loss(options.loss, options.loss_scale);
  const double consistency = gaussian_consistency(loss, structure.states);
  return {structure, std::move(loss), consistency, options.covariance, options.max_iterations};
}

LocalModel failed_fit(const LinearStructure& structure) { return failed_fit(structure.parameters(), structure.states); }

LocalModel fit_transitions(const Transitions& transitions, const Decomposition& decomposition,
                           const Estimator& estimator, const NoiseScale& scale, const ParameterPrior* prior) {
  const LinearStructure& structure = estimator.structure;
  const WhitenedProblem problem = whiten(transitions, decomposition, scale.sigma, prior);
  const Minimum minimum = minimise(problem, estimator.loss, estimator.max_iterations);
  if (minimum.status == FitStatus::failed) return failed_fit(structure);
  const RobustTerms terms = evaluate(problem, estimator.loss, minimum.z);
  LocalModel fit =
      describe_fit({problem, terms, transitions, estimator.loss, estimator.consistency, estimator.covariance, scale,
                    prior, static_cast<double>(structure.regressors()), static_cast<double>(decomposition.rank())},
                   problem.theta(minimum.z));
  if (!fit.theta.allFinite()) return fit;
  fit.condition = decomposition.condition;
  fit.rank = structure.states * decomposition.rank();
  fit.status = decomposition.rank() < structure.regressors() ? FitStatus::rank_deficient : minimum.status;
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
