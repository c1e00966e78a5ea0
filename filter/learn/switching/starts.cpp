#include "filter/learn/switching/starts.hpp"

#include <algorithm>
#include <optional>
#include <random>
#include <unsupported/Eigen/KroneckerProduct>
#include <utility>

#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/switching/em.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/seed.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
Eigen::MatrixXd unit_information(const TrainingTransitions& transitions, const Eigen::MatrixXd& Q,
                                 double least_information) {
  const Eigen::MatrixXd& X = transitions.data.regressors;
  const Eigen::MatrixXd G = X.transpose() * transitions.usable.asDiagonal() * X / transitions.usable.sum();
  const std::optional<Eigen::MatrixXd> Q_inverse = definite_inverse(Q);
  if (!Q_inverse)
    throw DataError(
        "the states' residuals in the training runs are linearly dependent: one state follows from "
        "the others; leave it out of data.state");
  Eigen::MatrixXd information = Eigen::kroneckerProduct(*Q_inverse, G);
  information.diagonal().array() += least_information * information.diagonal().maxCoeff();
  return information;
}

SwitchingPrior switching_prior(const TrainingTransitions& transitions, const GlobalModel& global,
                               const Eigen::VectorXd& prior_sd, double noise_transitions, const RefineTuning& tuning) {
  SwitchingPrior prior;
  prior.mean = global.theta;
  prior.noise = global.residual_covariance;
  prior.noise.diagonal() = prior.noise.diagonal().unaryExpr(&positive_variance) * (1.0 + 1e-9);
  prior.noise_transitions = noise_transitions;
  prior.counts = label_count_smoothing;
  prior.information = prior_sd.size() > 0 ? Eigen::MatrixXd(prior_sd.array().square().inverse().matrix().asDiagonal())
                                          : unit_information(transitions, prior.noise, tuning.least_information);
  return prior;
}

SwitchingRegression start_from_stretches(const TrainingTransitions& transitions, const SwitchingPrior& prior,
                                         Index modes, Index length, std::uint64_t seed, Index index,
                                         const RefineTuning& tuning) {
  std::mt19937_64 generator = make_generator(seed, "refine", static_cast<std::uint64_t>(index));
  const Index N = transitions.count();
  length = std::clamp(length, Index{1}, N);
  std::vector<Index> slots(static_cast<std::size_t>(std::max(N / length, Index{1})));
  for (std::size_t i = 0; i < slots.size(); ++i) slots[i] = static_cast<Index>(i) * length;
  for (std::size_t i = slots.size() - 1; i > 0; --i) std::swap(slots[i], slots[generator() % (i + 1)]);

  SwitchingRegression model;
  model.theta = prior.mean.replicate(1, modes);
  model.Q.assign(static_cast<std::size_t>(modes), prior.noise);
  model.transition = TransitionMatrix::sticky(modes, tuning.start_stay).matrix();
  model.initial = Eigen::VectorXd::Constant(modes, 1.0 / static_cast<double>(modes));
  ModePosterior posterior{Eigen::MatrixXd::Zero(N, modes), Eigen::MatrixXd::Zero(modes, modes),
                          Eigen::VectorXd::Zero(modes)};
  for (Index j = 0; j < modes; ++j)
    posterior.probability.col(j).segment(slots[static_cast<std::size_t>(j) % slots.size()], length).setOnes();
  const SwitchingSums sums = sum_transitions(transitions, posterior, prior);
  const SwitchingRegression fitted =
      maximise(transitions.structure, sums, prior, {.alternations = tuning.alternations}, model);
  model.theta = fitted.theta;
  model.Q = fitted.Q;
  return model;
}

SwitchingPrior towards_one_motion(SwitchingPrior prior, const TrainingTransitions& transitions,
                                  SwitchingRegression model, double theta_transitions, const RefineTuning& tuning) {
  if (!(theta_transitions > 0.0)) return prior;
  model.logit = {};
  model.theta.colwise() = prior.mean;
  ExpectationMaximisation one(transitions, prior, {.one_theta = true, .alternations = tuning.alternations},
                              std::move(model));
  for (Index i = 0; i < tuning.one_motion_iterations && !one.converged(); ++i) one.step();
  prior.mean = one.model().theta.col(0);
  prior.information += theta_transitions * unit_information(transitions, prior.noise, tuning.least_information);
  return prior;
}

}  // namespace modebank
