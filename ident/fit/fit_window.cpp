#include "ident/fit/fit_window.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "ident/base/not_a_number.hpp"
#include "ident/fit/describe.hpp"
#include "ident/fit/minimise.hpp"

namespace modebank {

namespace {

bool positive(const Eigen::VectorXd& values) { return (values.array() > 0.0).all() && values.allFinite(); }

void check_range(const Trajectory& run, Index start, Index length) {
  if (length < 1 || start < 0 || start + length > run.transitions())
    throw std::invalid_argument("window of " + std::to_string(length) + " transitions from sample " +
                                std::to_string(start) + " is not inside run '" + run.run + "' with " +
                                std::to_string(run.transitions()) + " transitions");
}

void check_arguments(const LinearStructure& structure, const Eigen::VectorXd& sigma, const Eigen::VectorXd& floor,
                     const ParameterPrior* prior) {
  if (sigma.size() != structure.states || !positive(sigma))
    throw std::invalid_argument("sigma needs " + std::to_string(structure.states) + " positive entries");
  if (floor.size() != structure.states || !(floor.array() >= 0.0).all() || !floor.allFinite())
    throw std::invalid_argument("sigma floor needs " + std::to_string(structure.states) + " nonnegative entries");
  if (prior && (prior->mean.size() != structure.parameters() || prior->sd.size() != structure.parameters() ||
                !positive(prior->sd) || !prior->mean.allFinite()))
    throw std::invalid_argument("prior needs " + std::to_string(structure.parameters()) +
                                " finite means and positive standard deviations");
}

}  // namespace

LocalModel fit_window(const Trajectory& run, Index start, const LinearStructure& structure, const FitOptions& options,
                      const Eigen::VectorXd& sigma, const ParameterPrior* prior, const Eigen::VectorXd& sigma_floor) {
  const Eigen::VectorXd floor = sigma_floor.size() > 0 ? sigma_floor : Eigen::VectorXd::Zero(structure.states);
  check_range(run, start, options.length);
  check_arguments(structure, sigma, floor, prior);
  const Transitions transitions = finite_rows(stack_transitions(run, start, options.length, structure));
  if (transitions.count() == 0) return failed_fit(structure.parameters(), structure.states);
  return fit_transitions(transitions, decompose(transitions.regressors, excitation_tolerance),
                         make_estimator(structure, options), {sigma, floor}, prior);
}

Estimator make_estimator(const LinearStructure& structure, const FitOptions& options) {
  RobustLoss loss(options.loss, options.loss_scale);
  const double consistency = gaussian_consistency(loss, structure.states);
  return {structure, std::move(loss), consistency, options.covariance, options.max_iterations};
}

LocalModel fit_transitions(const Transitions& transitions, const Decomposition& decomposition,
                           const Estimator& estimator, const NoiseScale& scale, const ParameterPrior* prior) {
  const LinearStructure& structure = estimator.structure;
  const WhitenedProblem problem = whiten(transitions, decomposition, scale.sigma, prior);
  const Minimum minimum = minimise(problem, estimator.loss, estimator.max_iterations);
  if (minimum.status == FitStatus::failed) return failed_fit(structure.parameters(), structure.states);
  const RobustTerms terms = evaluate(problem, estimator.loss, minimum.z);
  LocalModel fit = describe_fit({.problem = problem,
                                 .terms = terms,
                                 .transitions = transitions,
                                 .consistency = estimator.consistency,
                                 .covariance = estimator.covariance,
                                 .scale = scale,
                                 .prior = prior,
                                 .unknowns_per_state = static_cast<double>(structure.regressors()),
                                 .rank_per_state = static_cast<double>(decomposition.rank())},
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
