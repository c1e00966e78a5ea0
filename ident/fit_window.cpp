#include "ident/fit_window.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "ident/fit_transitions.hpp"

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
  if (transitions.count() == 0) return failed_fit(structure);
  return fit_transitions(transitions, decompose(transitions.regressors, excitation_tolerance),
                         make_estimator(structure, options), {sigma, floor}, prior);
}

}  // namespace modebank
