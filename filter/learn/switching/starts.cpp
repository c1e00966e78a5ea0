#include "filter/refine_start.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <unsupported/Eigen/KroneckerProduct>

#include "filter/definite_inverse.hpp"
#include "filter/noise_floor.hpp"
#include "filter/transition_learning.hpp"
#include "ident/seed.hpp"

namespace modebank {
namespace {

constexpr double least_information = 1e-8;  // share of the mean information that every direction of theta gets
constexpr double start_stay = 0.95;         // method section 4's

/// Information that one transition carries on average, made definite.
Eigen::MatrixXd unit_information(const TrainingTransitions& transitions, const Eigen::MatrixXd& Q) {
  const Eigen::MatrixXd& X = transitions.data.regressors;
  const Eigen::MatrixXd G = X.transpose() * transitions.usable.asDiagonal() * X / transitions.usable.sum();
  const Eigen::MatrixXd Q_inverse = definite_inverse(Q);
  Eigen::MatrixXd information = Eigen::kroneckerProduct(Q_inverse, G);
  information.diagonal().array() += least_information * information.diagonal().maxCoeff();
  return information;
}

}  // namespace

SwitchingPrior switching_prior(const TrainingTransitions& transitions, const GlobalModel& global,
                               const Eigen::VectorXd& prior_sd, double noise_transitions) {
  SwitchingPrior prior;
  prior.mean = global.theta;
  prior.noise = global.residual_covariance;
  prior.noise.diagonal() = prior.noise.diagonal().unaryExpr(&positive_variance) * (1.0 + 1e-9);
  prior.noise_transitions = noise_transitions;
  prior.counts = label_count_smoothing;
  prior.information = prior_sd.size() > 0 ? Eigen::MatrixXd(prior_sd.array().square().inverse().matrix().asDiagonal())
                                          : unit_information(transitions, prior.noise);
  return prior;
}

SwitchingRegression switching_model(const Bank& bank) {
  SwitchingRegression model;
  const Index n = bank.structure.states;
  model.theta.resize(bank.structure.parameters(), bank.mode_count());
  for (Index j = 0; j < bank.mode_count(); ++j) {
    model.theta.col(j) = bank.theta(j);
    model.Q.push_back(bank.modes[static_cast<std::size_t>(j)].Q.topLeftCorner(n, n));
  }
  model.transition = bank.transition.matrix();
  model.initial = bank.initial_probability;
  return model;
}

SwitchingRegression start_from_stretches(const TrainingTransitions& transitions, const SwitchingPrior& prior,
                                         Index modes, Index length, std::uint64_t seed, Index index) {
  std::mt19937_64 generator = make_generator(seed, "refine", static_cast<std::uint64_t>(index));
  const Index N = transitions.count();
  length = std::clamp(length, Index{1}, N);
  std::vector<Index> slots(static_cast<std::size_t>(std::max(N / length, Index{1})));
  for (std::size_t i = 0; i < slots.size(); ++i) slots[i] = static_cast<Index>(i) * length;
  for (std::size_t i = slots.size() - 1; i > 0; --i) std::swap(slots[i], slots[generator() % (i + 1)]);

  SwitchingRegression model;
  model.theta = prior.mean.replicate(1, modes);
  model.Q.assign(static_cast<std::size_t>(modes), prior.noise);
  model.transition = TransitionMatrix::sticky(modes, start_stay).matrix();
  model.initial = Eigen::VectorXd::Constant(modes, 1.0 / static_cast<double>(modes));
  ModePosterior posterior{Eigen::MatrixXd::Zero(N, modes), Eigen::MatrixXd::Zero(modes, modes),
                          Eigen::VectorXd::Zero(modes)};
  for (Index j = 0; j < modes; ++j)
    posterior.probability.col(j).segment(slots[static_cast<std::size_t>(j) % slots.size()], length).setOnes();
  const Eigen::MatrixXd transition = model.transition;
  maximise(transitions.structure, sum_transitions(transitions, posterior, prior), prior, SharedParts::none, model);
  model.transition = transition;
  model.initial.setConstant(1.0 / static_cast<double>(modes));
  return model;
}

}  // namespace modebank
