#include "filter/learn/switching/logit.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/KroneckerProduct>
#include <utility>
#include <vector>

#include "filter/learn/switching/screening.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/base/linalg.hpp"

namespace modebank {
namespace {

// Prior standard deviations of the weights in units of the regressors' standard deviation. With the larger one a border
// is a three hundredth of a standard deviation wide. The number of modes is chosen with the smaller one.
constexpr double first_width = 30.0, other_width = 300.0;
constexpr double negligible_share = 1e-12;  // smallest weight for which a mode's transitions are counted

// ridge, as a share of the largest curvature; needed because adding a constant to a row of log T has no effect
constexpr double curvature_ridge = 1e-10;
constexpr int most_halvings = 30;

Index regressor_count(const LinearStructure& s) { return s.dimension() + s.acting_inputs(); }

/// The expected log posterior of switches as a function of b = log T (up to constants in rows) and of the weights W.
/// The vector of unknowns holds b row by row, then W column by column.
class SwitchObjective {
 public:
  SwitchObjective(const TrainingTransitions& transitions, const ModePosterior& posterior, const SwitchingPrior& prior,
                  const SwitchingRegression& model)
      : pairs_(posterior.pairs),
        prior_(prior),
        K_(model.modes()),
        d_(regressor_count(transitions.structure)),
        z_((transitions.data.regressors.leftCols(d_).rowwise() - model.logit.reference.transpose()).transpose()) {
    // A transition with a missing sample switches by T, without state and input.
    for (Index k = 0; k < z_.cols(); ++k)
      if (transitions.usable(k) == 0.0) z_.col(k).setZero();
  }

  Eigen::VectorXd pack(const SwitchingRegression& model) const {
    Eigen::VectorXd at(K_ * K_ + K_ * d_);
    at << model.transition.array().max(std::numeric_limits<double>::min()).log().matrix().transpose().reshaped(),
        model.logit.weights.reshaped();
    return at;
  }
  void unpack(const Eigen::VectorXd& at, SwitchingRegression& model) const {
    model.transition = rows_of_T(at);
    model.logit.weights = at.tail(K_ * d_).reshaped(K_, d_);
  }

  /// The value and, unless null, the gradient and the negative Hessian (lower triangle).
  double evaluate(const Eigen::VectorXd& at, Eigen::VectorXd* gradient, Eigen::MatrixXd* curvature) const {
    const Eigen::MatrixXd T = rows_of_T(at), W = at.tail(K_ * d_).reshaped(K_, d_);
    double value = of_prior(T, W, gradient, curvature);
    Eigen::MatrixXd P(K_, K_), of_row(K_, K_), of_weights(K_, K_);
    Eigen::VectorXd surprise(K_);
    for (Index k = 0; k < z_.cols(); ++k) {
      const Eigen::VectorXd z = z_.col(k);
      set_probabilities(T, W * z, P);
      const auto xi = pairs_.col(k).reshaped(K_, K_);
      of_weights.setZero();
      surprise.setZero();
      for (Index i = 0; i < K_; ++i) {
        const double weight = xi.row(i).sum();
        if (weight < negligible_share) continue;
        const Eigen::VectorXd p = P.row(i).transpose(), target = xi.row(i).transpose();
        value += target.dot(p.cwiseMax(std::numeric_limits<double>::min()).array().log().matrix());
        if (!gradient) continue;
        const Eigen::VectorXd difference = target - weight * p;
        gradient->segment(i * K_, K_) += difference;
        surprise += difference;
        of_row = -weight * (p * p.transpose());
        of_row.diagonal() += weight * p;
        of_weights += of_row;
        curvature->block(i * K_, i * K_, K_, K_) += of_row;
        curvature->block(K_ * K_, i * K_, K_ * d_, K_) += Eigen::kroneckerProduct(z, of_row).eval();
      }
      if (!gradient) continue;
      gradient->tail(K_ * d_) += Eigen::kroneckerProduct(z, surprise).eval();
      const Eigen::MatrixXd squares = z * z.transpose();
      curvature->bottomRightCorner(K_ * d_, K_ * d_) += Eigen::kroneckerProduct(squares, of_weights).eval();
    }
    return value;
  }

 private:
  const Eigen::MatrixXd& pairs_;
  const SwitchingPrior& prior_;
  Index K_, d_;
  Eigen::MatrixXd z_;  ///< d x N, regressors relative to the reference

  Eigen::MatrixXd rows_of_T(const Eigen::VectorXd& at) const {
    Eigen::MatrixXd T = at.head(K_ * K_).reshaped(K_, K_).transpose();
    for (Index i = 0; i < K_; ++i) {
      T.row(i) = (T.row(i).array() - T.row(i).maxCoeff()).exp();
      T.row(i) /= T.row(i).sum();
    }
    return T;
  }

  void set_probabilities(const Eigen::MatrixXd& T, const Eigen::VectorXd& odds, Eigen::MatrixXd& P) const {
    const Eigen::VectorXd factor = (odds.array() - odds.maxCoeff()).max(-largest_log_odds).exp();
    P = T * factor.asDiagonal();
    for (Index i = 0; i < K_; ++i) P.row(i) /= P.row(i).sum();
  }

  /// The prior's part. Sets the gradient and the curvature to it.
  double of_prior(const Eigen::MatrixXd& T, const Eigen::MatrixXd& W, Eigen::VectorXd* gradient,
                  Eigen::MatrixXd* curvature) const {
    const Eigen::VectorXd information = prior_.weight_sd.array().square().inverse();
    if (gradient) {
      const auto K = static_cast<double>(K_);
      curvature->setZero(K_ * K_ + K_ * d_, K_ * K_ + K_ * d_);
      for (Index i = 0; i < K_; ++i) {
        const Eigen::VectorXd p = T.row(i).transpose();
        curvature->block(i * K_, i * K_, K_, K_) = -prior_.counts * K * (p * p.transpose());
        curvature->block(i * K_, i * K_, K_, K_).diagonal() += prior_.counts * K * p;
      }
      curvature->diagonal().tail(K_ * d_) = information.transpose().replicate(K_, 1).reshaped();
      gradient->resize(K_ * K_ + K_ * d_);
      *gradient << (prior_.counts * (1.0 - K * T.array())).matrix().transpose().reshaped(),
          (-(W * information.asDiagonal())).reshaped();
    }
    return prior_.counts * T.array().log().sum() - 0.5 * (W.array().square().matrix() * information).sum();
  }
};

/// A model with a logit, fitted to all training runs.
struct LogitStart {
  std::size_t row;    ///< row of the fit with constant T from which this model started
  RefineStart start;  ///< its priors are kept
  double log_likelihood;

  Index modes() const { return start.model.modes(); }
};

LogitStart gone_on(const RefineInput& in, std::size_t row, RefineStart start) {
  start.logit_width = first_width;
  const SwitchingPrior prior = in.prior(start);
  ExpectationMaximisation em(in.transitions, prior, in.em(), start.model);
  for (Index i = 0; i < in.options.max_iterations && !em.converged(); ++i) em.step();
  start.model = em.model();
  return {row, std::move(start), em.posterior().log_likelihood};
}

/// Continues every start's fit with constant T as a logit. Empty for one mode, which does not switch.
std::vector<LogitStart> from_constant_fits(const RefineInput& in, const std::vector<Fit>& fits) {
  std::vector<std::optional<LogitStart>> all(fits.size());
  tbb::parallel_for(std::size_t{0}, fits.size(), [&](std::size_t f) {
    RefineStart start = fits[f].start;
    start.model = fit_training_runs(in, start, fits[f].iterations).model;
    if (start.model.modes() == 1) return;
    start.model.logit = no_effect(in.transitions, start.model.modes());
    all[f] = gone_on(in, fits[f].row, std::move(start));
  });
  std::vector<LogitStart> starts;
  for (std::optional<LogitStart>& start : all)
    if (start) starts.push_back(std::move(*start));
  return starts;
}

bool likelier(const LogitStart& a, const LogitStart& b) { return a.log_likelihood > b.log_likelihood; }

/// The most likely model of each number of modes, the most modes first. The candidates are the continued fits with
/// constant T. Further candidates come from the best of these fits, by merging one pair of modes after another.
std::vector<LogitStart> logit_starts(const RefineInput& in, const std::vector<Fit>& fits) {
  std::vector<LogitStart> all = from_constant_fits(in, fits);
  if (all.empty()) return all;
  LogitStart last = *std::min_element(all.begin(), all.end(), likelier);
  while (last.modes() > 2) {
    const ModePosterior posterior = smooth_modes(in.transitions, last.start.model);
    last.start.model = with_closest_pair_merged(in.transitions, posterior, last.start.model);
    last = gone_on(in, last.row, std::move(last.start));
    all.push_back(last);
  }
  std::sort(all.begin(), all.end(), likelier);
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.modes() > b.modes(); });
  const auto as_many = [](const auto& a, const auto& b) { return a.modes() == b.modes(); };
  all.erase(std::unique(all.begin(), all.end(), as_many), all.end());
  return all;
}

/// Continues from a start on every split, and chooses the best number of iterations.
Fit scored(const CrossValidation& validation, LogitStart from, double width) {
  from.start.logit_width = width;
  Fit fit = validation.best_iterations(from.start);
  fit.row = from.row;
  return fit;
}

}  // namespace

TransitionLogit no_effect(const TrainingTransitions& transitions, Index modes) {
  const Index d = regressor_count(transitions.structure);
  return {Eigen::MatrixXd::Zero(modes, d),
          transitions.data.regressors.leftCols(d).transpose() * transitions.usable / transitions.usable.sum()};
}

SwitchingPrior with_logit_prior(SwitchingPrior prior, const TrainingTransitions& transitions, double width) {
  if (width == 0.0) return prior;
  const Index d = regressor_count(transitions.structure);
  const auto z = transitions.data.regressors.leftCols(d);
  const double N = transitions.usable.sum();
  const Eigen::VectorXd mean = z.transpose() * transitions.usable / N;
  prior.weight_sd.setConstant(d, width);
  for (Index a = 0; a < d; ++a) {
    const double sd = std::sqrt(transitions.usable.dot((z.col(a).array() - mean(a)).square().matrix()) / N);
    if (sd > 1e-12 * std::abs(mean(a))) prior.weight_sd(a) /= sd;
  }
  return prior;
}

double raise_switching(const TrainingTransitions& transitions, const ModePosterior& posterior,
                       const SwitchingPrior& prior, SwitchingRegression& model) {
  const SwitchObjective objective(transitions, posterior, prior, model);
  const Eigen::VectorXd start = objective.pack(model);
  Eigen::VectorXd gradient;
  Eigen::MatrixXd curvature;
  const double before = objective.evaluate(start, &gradient, &curvature);
  curvature.triangularView<Eigen::StrictlyUpper>() = curvature.transpose();
  curvature.diagonal().array() += curvature_ridge * curvature.diagonal().maxCoeff();
  const Eigen::VectorXd newton = solve_semidefinite(curvature, gradient);
  double share = 1.0;
  for (int i = 0; i < most_halvings; ++i, share *= 0.5) {
    const Eigen::VectorXd at = start + share * newton;
    const double gain = at.allFinite() ? objective.evaluate(at, nullptr, nullptr) - before : -1.0;
    if (!(gain > 0.0)) continue;
    objective.unpack(at, model);
    return gain;
  }
  return 0.0;
}

std::optional<Fit> choose_logit(const RefineInput& in, const CrossValidation& validation, SwitchingStage& stage) {
  if (!validation.possible()) return std::nullopt;
  std::vector<Fit> sizes;
  std::vector<LeftOutScores> scores;
  const std::vector<LogitStart> starts = logit_starts(in, validation.best_of_starts());
  for (const LogitStart& start : starts) {
    sizes.push_back(scored(validation, start, first_width));
    scores.push_back(sizes.back().scores);
  }
  if (sizes.empty()) return std::nullopt;
  const std::size_t size = fewest_modes_as_good(scores, validation.samples(), refine_tuning);
  Fit best = sizes[size];
  Fit other = scored(validation, starts[size], other_width);
  if (validation.mean_score(other.scores) > validation.mean_score(best.scores)) best = std::move(other);

  const LeftOutScores& without = validation.chosen().scores;
  const PairedLoss gain = paired_loss(best.scores.log_likelihood, without.log_likelihood, validation.samples());
  stage.score_before = validation.mean_score(without);
  stage.gain = gain.mean;
  stage.gain_standard_error = gain.standard_error;
  if (!is_worth_it(gain, validation.samples())) return std::nullopt;
  stage.width = best.start.logit_width;
  return best;
}

}  // namespace modebank
