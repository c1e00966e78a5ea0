// Transition probabilities that depend on state and input (TransitionLogit).
#include <tbb/parallel_for.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <unsupported/Eigen/KroneckerProduct>
#include <utility>

#include "filter/learn/refine/cross_validation.hpp"
#include "filter/learn/switching/regression.hpp"
#include "filter/step/motions.hpp"
#include "ident/base/linalg.hpp"

namespace modebank {
namespace {

// Prior standard deviations of the weights in units of the regressors' standard deviation. With the larger one a border
// is a three hundredth of it wide. The number of modes is chosen with the smaller one.
constexpr double first_width = 30.0, other_width = 300.0;
constexpr double negligible_share = 1e-12;  // smallest weight for which a mode's transitions are counted
// ridge, as a share of the largest curvature; needed because adding a constant to a row of log T has no effect
constexpr double curvature_ridge = 1e-10;
constexpr int most_halvings = 30;

/// The expected log posterior of switches, its gradient and negative Hessian (lower triangle) by b = log T, up to
/// constants in rows, and by the weights W: b row by row, then W column by column.
struct SwitchObjective {
  double value = 0.0;
  Eigen::VectorXd gradient = {};
  Eigen::MatrixXd curvature = {};
};

/// Adds the expected numbers of `switches` from i to j at one z, relative to the reference.
void add(const Eigen::VectorXd& z, const Eigen::MatrixXd& switches, const SwitchingRegression& at,
         SwitchObjective& sum) {
  const Index K = at.modes(), of_T = K * K, of_W = K * z.size();
  const Eigen::VectorXd odds = at.logit.weights * z;
  const Eigen::VectorXd factor = (odds.array() - odds.maxCoeff()).max(-largest_log_odds).exp();
  Eigen::MatrixXd of_weights = Eigen::MatrixXd::Zero(K, K);
  Eigen::VectorXd surprise = Eigen::VectorXd::Zero(K);
  for (Index i = 0; i < K; ++i) {
    const Eigen::VectorXd target = switches.row(i);
    const double weight = target.sum();
    if (weight < negligible_share) continue;
    Eigen::VectorXd p = at.transition.row(i).transpose().cwiseProduct(factor);
    p /= p.sum();
    sum.value += target.dot(p.cwiseMax(std::numeric_limits<double>::min()).array().log().matrix());
    if (sum.gradient.size() == 0) continue;
    sum.gradient.segment(i * K, K) += target - weight * p;
    surprise += target - weight * p;
    Eigen::MatrixXd of_row = -weight * (p * p.transpose());
    of_row.diagonal() += weight * p;
    of_weights += of_row;
    sum.curvature.block(i * K, i * K, K, K) += of_row;
    sum.curvature.block(of_T, i * K, of_W, K) += Eigen::kroneckerProduct(z, of_row).eval();
  }
  if (sum.gradient.size() == 0) return;
  sum.gradient.tail(of_W) += Eigen::kroneckerProduct(z, surprise).eval();
  const Eigen::MatrixXd squares = z * z.transpose();
  sum.curvature.bottomRightCorner(of_W, of_W) += Eigen::kroneckerProduct(squares, of_weights).eval();
}

SwitchObjective objective_at(const SwitchingRegression& at, const TrainingTransitions& transitions,
                             const ModePosterior& posterior, const SwitchingPrior& prior, bool slopes) {
  const Eigen::MatrixXd& W = at.logit.weights;
  const Index K = at.modes(), d = W.cols();
  const Eigen::VectorXd information = prior.weight_sd.array().square().inverse();
  SwitchObjective sum{-0.5 * (W.array().square().matrix() * information).sum()};
  if (slopes) {
    sum.gradient.setZero(K * (K + d));
    sum.gradient.tail(K * d) = -(W * information.asDiagonal()).reshaped();
    sum.curvature.setZero(K * (K + d), K * (K + d));
    sum.curvature.diagonal().tail(K * d) = information.transpose().replicate(K, 1).reshaped();
  }
  // The prior on T counts as further transitions at the reference. A transition with a missing sample switches by T.
  const Eigen::VectorXd reference = Eigen::VectorXd::Zero(d);
  add(reference, Eigen::MatrixXd::Constant(K, K, prior.counts), at, sum);
  for (Index k = 0; k < transitions.count(); ++k) {
    const Eigen::VectorXd z = transitions.data.regressors.row(k).head(d).transpose() - at.logit.reference;
    add(transitions.usable(k) > 0.0 ? z : reference, posterior.pairs.col(k).reshaped(K, K), at, sum);
  }
  return sum;
}

SwitchingRegression moved(SwitchingRegression model, const Eigen::VectorXd& step) {
  const Index K = model.modes(), d = model.logit.weights.cols();
  const Eigen::MatrixXd b = step.head(K * K).reshaped(K, K).transpose();
  for (Index i = 0; i < K; ++i) {
    auto row = model.transition.row(i);
    row = row.array() * (b.row(i).array() - b.row(i).maxCoeff()).exp();
    row /= row.sum();
  }
  model.logit.weights += step.tail(K * d).reshaped(K, d);
  return model;
}

/// A model with a logit, fitted to all training runs.
struct LogitFit {
  BankCandidate candidate;
  double log_likelihood;
};

LogitFit gone_on(const RefineInput& in, BankCandidate candidate) {
  candidate.logit_width = first_width;
  SwitchingFit fit{std::move(candidate.start)};
  iterate(in.all.transitions, in.prior(in.all, first_width), in.em(), in.options.max_iterations, fit);
  candidate.start = std::move(fit.model);
  return {std::move(candidate), fit.posterior.log_likelihood};
}

/// The most likely model of each number of modes, the most modes first. Every start's fit with constant T continues as
/// a logit. Further candidates come from the likeliest of these, by merging one pair of modes after another. Empty if
/// all fits have one mode, which does not switch.
std::map<Index, LogitFit, std::greater<>> fits_by_size(const RefineInput& in, const std::vector<Fit>& constant) {
  std::vector<LogitFit> all(constant.size());
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t f) {
    BankCandidate candidate = constant[f].candidate;
    candidate.start = fit_training_runs(in, candidate).model;
    if (candidate.start.modes() == 1) return;
    candidate.start.noise_levels = 1;
    candidate.start.logit = no_effect(in.all.transitions, candidate.start.modes());
    all[f] = gone_on(in, std::move(candidate));
  });
  std::erase_if(all, [](const LogitFit& fit) { return fit.candidate.start.modes() == 0; });
  if (all.empty()) return {};
  const auto less_likely = [](const LogitFit& a, const LogitFit& b) { return a.log_likelihood < b.log_likelihood; };
  LogitFit last = *std::max_element(all.begin(), all.end(), less_likely);
  while (last.candidate.start.modes() > 2) {
    SwitchingRegression& model = last.candidate.start;
    merge_closest_pair(in.all.transitions, smooth_modes(in.all.transitions, model), model);
    last = gone_on(in, std::move(last.candidate));
    all.push_back(last);
  }
  std::stable_sort(all.begin(), all.end(), less_likely);
  std::map<Index, LogitFit, std::greater<>> best;
  for (LogitFit& fit : all) best.insert_or_assign(fit.candidate.start.modes(), std::move(fit));
  return best;
}

}  // namespace

TransitionLogit no_effect(const TrainingTransitions& transitions, Index modes) {
  const Index d = transitions.structure.dimension() + transitions.structure.acting_inputs();
  return {Eigen::MatrixXd::Zero(modes, d),
          transitions.data.regressors.leftCols(d).transpose() * transitions.usable / transitions.usable.sum()};
}

void raise_switching(const TrainingTransitions& transitions, const ModePosterior& posterior,
                     const SwitchingPrior& prior, SwitchingRegression& model) {
  auto [before, gradient, curvature] = objective_at(model, transitions, posterior, prior, true);
  curvature.triangularView<Eigen::StrictlyUpper>() = curvature.transpose();
  curvature.diagonal().array() += curvature_ridge * curvature.diagonal().maxCoeff();
  Eigen::VectorXd newton = solve_semidefinite(curvature, gradient);
  if (!newton.allFinite()) return;
  for (int i = 0; i < most_halvings; ++i, newton *= 0.5)
    if (const auto next = moved(model, newton);
        objective_at(next, transitions, posterior, prior, false).value > before) {
      model = next;
      return;
    }
}

std::optional<Fit> choose_logit(const RefineInput& in, const CrossValidation& validation, SwitchingStage& stage) {
  if (!validation.possible()) return std::nullopt;
  std::vector<Fit> sizes;
  std::vector<LeftOutScores> scores;
  for (const auto& [modes, fit] : fits_by_size(in, validation.best_of_starts())) {
    sizes.push_back(validation.best_iterations(fit.candidate));
    scores.push_back(sizes.back().scores);
  }
  if (sizes.empty()) return std::nullopt;
  Fit best = sizes[fewest_motions_as_good(scores, least_nats(validation.samples().sum(), in.single.response_samples))];
  BankCandidate wider = best.candidate;
  wider.logit_width = other_width;
  Fit other = validation.best_iterations(wider);
  if (validation.mean_score(other.scores) > validation.mean_score(best.scores)) best = std::move(other);
  const LeftOutScores& without = validation.chosen().scores;
  const PairedLoss gain = paired_loss(best.scores.log_likelihood, without.log_likelihood, validation.samples());
  stage.score_before = validation.mean_score(without);
  stage.gain = gain.mean;
  stage.gain_standard_error = gain.standard_error;
  if (!is_worth_it(gain, validation.samples())) return std::nullopt;
  stage.width = best.candidate.logit_width;
  return best;
}

}  // namespace modebank
