#include "filter/learn/likelihood/information.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "filter/learn/refine/learning_part.hpp"

namespace modebank {
namespace {

constexpr double least_probability = 1e-100;  // smallest divisor whose square does not underflow

/// One row per sample, one column per coordinate, by central differences. A row is zero if the sample has no density.
Eigen::MatrixXd gradients_of_run(const BankCoordinates& around, const Eigen::VectorXd& steps, const Trajectory& run,
                                 const FilterOptions& filter, const LookAhead& look) {
  Eigen::MatrixXd gradients(run.samples(), around.size());
  tbb::parallel_for(Index{0}, around.size(), [&](Index c) {
    const Eigen::VectorXd step = steps(c) * Eigen::VectorXd::Unit(around.size(), c);
    gradients.col(c) = (look_ahead_scores(around.decode(step), run, filter, look) -
                        look_ahead_scores(around.decode(-step), run, filter, look)) /
                       (2.0 * steps(c));
  });
  return gradients.array().isNaN().select(0.0, gradients);
}

/// Inverse variances of Q and T by the prior alone. The prior on Q counts as a scatter of its number of transitions.
/// The prior on T counts as its number of switches, for every pair of modes. The most frequent switch of a row has no
/// coordinate of its own, because rows sum to one.
Eigen::VectorXd information_of_noise_and_switches(const BankCoordinates& around, const SwitchingPrior& prior) {
  const ParameterPlaces at = around.places();
  const Bank& bank = around.origin();
  const Index n = bank.structure.states;
  Eigen::VectorXd information = Eigen::VectorXd::Zero(at.size());
  for (Index j = 0; j < at.modes; ++j) {
    const Eigen::MatrixXd& Q = bank.modes[static_cast<std::size_t>(j)].Q;
    Index next = at.Q(j);
    for (Index b = 0; at.triangle > 0 && b < n; ++b)
      for (Index a = b; a < n; ++a)
        information(next++) = (a == b ? 0.5 : 1.0) * prior.noise_transitions / (Q(a, a) * Q(b, b));
    if (!at.transition || at.modes == 1) continue;
    const Eigen::RowVectorXd row = bank.transition.matrix().row(j).cwiseMax(least_probability);
    Index largest = 0;
    row.maxCoeff(&largest);
    for (Index k = 0; k < at.modes; ++k)
      if (k != largest) information(at.T(j) + k) = prior.counts / row(k) / row(k);
  }
  return information;
}

/// Information of the prior on the logit's memory about T.
Eigen::MatrixXd information_of_memory(const BankCoordinates& around, const SwitchingPrior& prior) {
  const Eigen::MatrixXd T = around.origin().transition.matrix().cwiseMax(least_probability);
  const Eigen::VectorXd of_log = T.transpose().reshaped().cwiseInverse() / prior.memory_sd;
  return of_log.asDiagonal() * memory_projection(T.rows()) * of_log.asDiagonal();
}

}  // namespace

SampleGradients sample_gradients(const BankCoordinates& around, const Eigen::VectorXd& steps,
                                 const Recording& recording, const FilterOptions& filter, const LookAhead& look) {
  SampleGradients result{Eigen::VectorXd::Zero(around.size()), Eigen::MatrixXd::Zero(around.size(), around.size())};
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train || run.samples() < 2) continue;
    const Eigen::MatrixXd gradients = gradients_of_run(around, steps, run, filter, look);
    result.sum += gradients.colwise().sum().transpose();
    result.information.noalias() += gradients.transpose() * gradients;
  }
  return result;
}

InformationSamples::InformationSamples(const Recording& recording, Index most)
    : part(learning_part(recording, most, 1)) {
  if (part)
    factor =
        static_cast<double>(recording.transitions(Role::train)) / static_cast<double>(part->transitions(Role::train));
}

SampleGradients exact_sample_gradients(const BankCoordinates& around, const Eigen::VectorXd& steps,
                                       const TrainingTransitions& transitions) {
  Eigen::MatrixXd gradients(transitions.count(), around.size());
  tbb::parallel_for(Index{0}, around.size(), [&](Index c) {
    const Eigen::VectorXd step = steps(c) * Eigen::VectorXd::Unit(around.size(), c);
    gradients.col(c) = (predictive_log_densities(transitions, switching_model(around.decode(step))) -
                        predictive_log_densities(transitions, switching_model(around.decode(-step)))) /
                       (2.0 * steps(c));
  });
  SampleGradients result{gradients.colwise().sum().transpose(), Eigen::MatrixXd::Zero(around.size(), around.size())};
  result.information.selfadjointView<Eigen::Lower>().rankUpdate(gradients.transpose());
  result.information.triangularView<Eigen::StrictlyUpper>() = result.information.transpose();
  return result;
}

Eigen::MatrixXd prior_information(const BankCoordinates& around, const SwitchingPrior& prior) {
  const ParameterPlaces at = around.places();
  const Eigen::MatrixXd J = around.jacobian();
  Eigen::MatrixXd information = J.transpose() * information_of_noise_and_switches(around, prior).asDiagonal() * J;
  const Index thetas = at.parameters == 0 ? 0 : around.has_one_theta() ? 1 : at.modes;
  for (Index j = 0; j < thetas; ++j) {
    const auto of_theta = J.middleRows(at.theta(j), at.parameters);
    information.noalias() += of_theta.transpose() * prior.information * of_theta;
  }
  if (at.transition && at.regressors > 0 && std::isfinite(prior.memory_sd)) {
    const auto of_T = J.middleRows(at.T(0), at.modes * at.modes);
    information.noalias() += of_T.transpose() * information_of_memory(around, prior) * of_T;
  }
  // The weights of the logit are the last coordinates. Their prior is directly on these coordinates.
  for (Index a = 0; a < at.regressors; ++a) {
    const double share = around.weight_unit()(a) / prior.weight_sd(a);
    information.diagonal().segment(around.size() - (at.regressors - a) * at.modes, at.modes).array() += share * share;
  }
  return information;
}

}  // namespace modebank
