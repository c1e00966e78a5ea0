#include "filter/learn/switching/em.hpp"

#include <algorithm>
#include <optional>
#include <random>
#include <unsupported/Eigen/KroneckerProduct>
#include <utility>

#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/switching/logit.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/seed.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// Maximises over theta and Q of all modes alternately: over theta with Q fixed, then over Q with theta fixed.
class ConditionalMaximiser {
 public:
  ConditionalMaximiser(const LinearStructure& structure, const SwitchingSums& sums, const SwitchingPrior& prior,
                       SwitchingRegression& model)
      : structure_(structure), sums_(sums), prior_(prior), model_(model) {}

  // If a Q is singular, theta does not change. The objective is then minus infinity, and such a fit is never chosen.
  void set_theta(Index j) {
    if (const auto best = best_theta(j, j + 1)) model_.theta.col(j) = *best;
  }
  void set_one_theta() {
    if (const auto best = best_theta(0, model_.modes())) model_.theta.colwise() = *best;
  }

  void set_noise(Index j) {
    const RegressionSums& of_mode = at(j);
    const Eigen::MatrixXd change = coefficients(structure_, model_.theta.col(j) - prior_.mean);
    noise(j) = (of_mode.scatter_after(change) + prior_.noise_transitions * prior_.noise) /
               (of_mode.weight + prior_.noise_transitions);
  }

 private:
  Eigen::MatrixXd& noise(Index j) { return model_.Q[static_cast<std::size_t>(j)]; }
  const RegressionSums& at(Index j) const { return sums_.modes[static_cast<std::size_t>(j)]; }

  /// The best theta of the modes `first` to `end` - 1, given the data and the prior; empty if a Q is not definite.
  std::optional<Eigen::VectorXd> best_theta(Index first, Index end) {
    Eigen::MatrixXd information = prior_.information;
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(prior_.mean.size());
    for (Index j = first; j < end; ++j) {
      const std::optional<Eigen::MatrixXd> Q_inverse = definite_inverse(noise(j));
      if (!Q_inverse) return std::nullopt;
      information += Eigen::kroneckerProduct(*Q_inverse, at(j).G).eval();
      const Eigen::MatrixXd of_mode = at(j).H * *Q_inverse;
      pull += of_mode.reshaped();
    }
    const Cholesky factor(information);  // an LDLT of 128 coefficients takes four times the time
    return prior_.mean + (factor.definite() ? factor.solve(pull) : solve_semidefinite(information, pull));
  }

  const LinearStructure& structure_;
  const SwitchingSums& sums_;
  const SwitchingPrior& prior_;
  SwitchingRegression& model_;
};

/// Average information of one transition about theta, for residuals of covariance Q, p x p. The share
/// `least_information` of its largest entry is added to make it definite.
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

}  // namespace

SwitchingRegression maximise(const LinearStructure& structure, const SwitchingSums& sums, const SwitchingPrior& prior,
                             const SwitchingEmOptions& options, SwitchingRegression model) {
  ConditionalMaximiser maximiser(structure, sums, prior, model);
  for (int i = 0; i < options.alternations; ++i) {
    if (options.one_theta) maximiser.set_one_theta();
    for (Index j = 0; j < model.modes(); ++j) {
      if (!options.one_theta) maximiser.set_theta(j);
      maximiser.set_noise(j);
    }
  }
  const Eigen::MatrixXd counts = sums.switches.array() + prior.counts;
  for (Index i = 0; i < model.modes(); ++i) {
    const double row = counts.row(i).sum();
    if (row > 0.0 && model.logit.empty()) model.transition.row(i) = counts.row(i) / row;
  }
  model.initial = sums.first.array() + prior.counts;
  model.initial /= model.initial.sum();
  return model;
}

ExpectationMaximisation::ExpectationMaximisation(const TrainingTransitions& transitions, const SwitchingPrior& prior,
                                                 const SwitchingEmOptions& options, SwitchingRegression start)
    : transitions_(transitions), prior_(prior), options_(options), model_(std::move(start)) {
  posterior_ = smooth_modes(transitions_, model_);
}

void ExpectationMaximisation::step() {
  if (converged_) return;
  objective_.push_back(posterior_.log_likelihood + log_prior(prior_, options_.one_theta, model_));
  const SwitchingSums sums = sum_transitions(transitions_, posterior_, prior_);
  model_ = maximise(transitions_.structure, sums, prior_, options_, std::move(model_));
  if (!model_.logit.empty()) raise_switching(transitions_, posterior_, prior_, model_);
  posterior_ = smooth_modes(transitions_, model_);
  const double gain = posterior_.log_likelihood + log_prior(prior_, options_.one_theta, model_) - objective_.back();
  // The first step moves from the optimum of the start to that of the prior. So the objective may fall in this step.
  converged_ = objective_.size() > 1 && !(gain >= options_.tolerance * static_cast<double>(transitions_.count()));
}

SwitchingPrior switching_prior(const TrainingTransitions& transitions, const GlobalModel& global,
                               const Eigen::VectorXd& prior_sd, double noise_transitions) {
  SwitchingPrior prior;
  prior.mean = global.theta;
  prior.noise = global.residual_covariance;
  prior.noise.diagonal() = prior.noise.diagonal().unaryExpr(&positive_variance) * (1.0 + 1e-9);
  prior.noise_transitions = noise_transitions;
  prior.counts = label_count_smoothing;
  prior.information = prior_sd.size() > 0 ? Eigen::MatrixXd(prior_sd.array().square().inverse().matrix().asDiagonal())
                                          : unit_information(transitions, prior.noise, refine_tuning.least_information);
  return prior;
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
  model.transition = TransitionMatrix::sticky(modes, refine_tuning.start_stay).matrix();
  model.initial = Eigen::VectorXd::Constant(modes, 1.0 / static_cast<double>(modes));
  ModePosterior posterior{Eigen::MatrixXd::Zero(N, modes), Eigen::MatrixXd::Zero(modes, modes),
                          Eigen::VectorXd::Zero(modes)};
  for (Index j = 0; j < modes; ++j)
    posterior.probability.col(j).segment(slots[static_cast<std::size_t>(j) % slots.size()], length).setOnes();
  const SwitchingSums sums = sum_transitions(transitions, posterior, prior);
  const SwitchingRegression fitted =
      maximise(transitions.structure, sums, prior, {.alternations = refine_tuning.alternations}, model);
  model.theta = fitted.theta;
  model.Q = fitted.Q;
  return model;
}

}  // namespace modebank
