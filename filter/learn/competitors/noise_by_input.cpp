// One factor on all noise of one motion, which depends on state and input (method: section 2a, item 5).
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/left_out/rule.hpp"
#include "filter/learn/switching/regression.hpp"
#include "ident/base/linalg.hpp"
#include "ident/fit/constants.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/fit/robust_regression.hpp"
#include "ident/fit/scale.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Directions over [z; v] that noise may depend on, one per row. `coefficients`: q x n.
MatrixXd candidate_directions(const LinearStructure& s, const MatrixXd& theta) {
  const Index n = s.dimension(), m = s.acting_inputs(), changes = s.input_lags > 1 ? s.inputs : 0;
  const Index forecasts = m > 1 ? s.states : 0;  // else it is that of the input
  MatrixXd directions = MatrixXd::Zero(s.states + s.inputs + changes + forecasts, n + m);
  directions.topLeftCorner(s.states, s.states).setIdentity();
  directions.block(s.states, n, s.inputs, s.inputs).setIdentity();
  directions.block(s.states + s.inputs, n, changes, changes).setIdentity();
  directions.block(s.states + s.inputs, n + changes, changes, changes).diagonal().setConstant(-1.0);
  directions.bottomRightCorner(forecasts, m) = theta.middleRows(n, m).transpose().topRows(forecasts);
  return directions;
}

/// Residuals divided by a robust scale of each column; columns of zeros are dropped.
MatrixXd standardised(MatrixXd E) {
  std::vector<Index> kept;
  for (Index i = 0; i < E.cols(); ++i) {
    const double sd = std::sqrt(E.col(i).squaredNorm() / static_cast<double>(E.rows()));
    const double scale = std::max(mad_to_sd * median(E.col(i).cwiseAbs()), 0.05 * sd);
    if (!(scale > 0.0)) continue;
    E.col(i) /= scale;
    kept.push_back(i);
  }
  return E(Eigen::all, kept);
}

/// Returns g of the scales exp(z'g). The last column of z is one. Uses Fisher scoring for a Student t, with a small
/// ridge.
VectorXd fit_scales(const MatrixXd& z, const MatrixXd& E) {
  constexpr double nu = 5.0;                // degrees of freedom of Student's t
  constexpr double ridge = 4.0;             // information of one sample about each standardised logarithm
  constexpr double largest_exponent = 6.0;  // of a scale during the search
  constexpr int most_steps = 25;
  VectorXd g = VectorXd::Zero(z.cols());
  const double per_sample = 2.0 * nu / (nu + 3.0) * static_cast<double>(E.cols());
  MatrixXd information = per_sample * z.transpose() * z;
  information.diagonal().array() += ridge;
  const Cholesky factor(information);
  for (int step = 0; step < most_steps && factor.definite(); ++step) {
    const Eigen::ArrayXd inverse = (-2.0 * (z * g).array().max(-largest_exponent).min(largest_exponent)).exp();
    const Eigen::ArrayXXd squares = E.array().square().colwise() * inverse;
    const VectorXd excess = ((nu + 1.0) * squares / (nu + squares) - 1.0).rowwise().sum();
    const VectorXd change = factor.solve(VectorXd(z.transpose() * excess - ridge * g)).cwiseMax(-1.0).cwiseMin(1.0);
    g += change;
    if (change.cwiseAbs().maxCoeff() < 1e-6) break;
  }
  return g;
}

/// One motion whose noise switches between levels, by expectation-maximisation. If noise is larger for a while, a
/// filter can follow it without an input. So the levels must be learned. With fixed levels, a factor seemed to gain
/// 0.15 nats per sample on DART's training runs.
SwitchingRegression switching_noise(const Recording& recording, const TrainingTransitions& transitions) {
  constexpr std::array levels{1.0 / 16.0, 0.25, 1.0, 4.0};  // at the start, as shares of the residuals' variance
  constexpr int most_steps = 15;
  const GlobalModel global = fit_global(recording, transitions.structure);
  const SwitchingPrior prior = switching_prior(transitions, global, {}, usual_Q_transitions);
  SwitchingRegression model;
  model.theta = global.theta.replicate(1, std::ssize(levels));
  for (const double level : levels) model.Q.emplace_back(level * prior.noise);
  model.transition = TransitionMatrix::sticky(std::ssize(levels), 0.9).matrix();
  model.initial = VectorXd::Constant(std::ssize(levels), 1.0 / static_cast<double>(levels.size()));
  SwitchingFit fit{std::move(model)};
  iterate(transitions, prior, {.one_theta = true, .tolerance = 1e-4}, most_steps, fit);
  return fit.model;
}

/// Per run of `judged`: sum over its rows of the log density that the factor adds, and the number of these rows.
MatrixXd gains(const Recording& learned, const Recording& judged, const LinearStructure& s) {
  if (stack_training(judged, s).count() == 0) return MatrixXd(0, 2);
  const TrainingTransitions rows = gather_training_transitions(learned, s),
                            of_judged = gather_training_transitions(judged, s);
  const NoiseFactor factor = fit_noise_factor(learned, s);
  const VectorXd with_factor =
      predictive_log_densities(gather_training_transitions(judged, s, factor),
                               switching_noise(learned, gather_training_transitions(learned, s, factor)));
  const VectorXd without = predictive_log_densities(of_judged, switching_noise(learned, rows));
  MatrixXd result(std::ssize(of_judged.runs), 2);
  result << sum_by_run(of_judged, with_factor - without), sum_by_run(of_judged, of_judged.usable);
  return result;
}

PairedLoss mean_gain(const MatrixXd& gains) {
  return paired_loss(gains.col(0), VectorXd::Zero(gains.rows()), gains.col(1));
}

}  // namespace

NoiseFactor fit_noise_factor(const Recording& recording, const LinearStructure& s, const MotionTerms& terms) {
  Transitions rows = stack_training(recording, s);
  require_transitions(rows.count() > 0);
  const MatrixXd linear = rows.regressors, bent = terms.empty() ? MatrixXd() : term_columns(terms, linear);
  rows.regressors.conservativeResize(Eigen::NoChange, linear.cols() + bent.cols());
  rows.regressors.rightCols(bent.cols()) = bent;
  const MatrixXd theta = huber_regression(rows).coefficients;
  const MatrixXd E = standardised(rows.increments - rows.regressors * theta);
  if (E.cols() == 0) return {};
  const auto N = static_cast<double>(rows.count());
  MatrixXd directions = candidate_directions(s, theta);
  const MatrixXd values = linear.leftCols(directions.cols()).rowwise() + s.acting_centre().transpose();
  Eigen::ArrayXXd z = (values * directions.transpose()).cwiseAbs().array();
  const Eigen::ArrayXd rms = (z.square().colwise().sum().transpose() / N).sqrt();
  z = (z.rowwise() / rms.transpose() + NoiseFactor::softening).log();
  const Eigen::ArrayXd mean = z.colwise().mean().transpose();
  z.rowwise() -= mean.transpose();
  const Eigen::ArrayXd sd = (z.square().colwise().sum().transpose() / N).sqrt();
  std::vector<Index> moving;
  for (Index i = 0; i < sd.size(); ++i)
    if (rms(i) > 0.0 && sd(i) > 1e-6) moving.push_back(i);
  if (moving.empty()) return {};
  MatrixXd with_constant = MatrixXd::Ones(z.rows(), std::ssize(moving) + 1);
  with_constant.leftCols(std::ssize(moving)) = (z.rowwise() / sd.transpose()).matrix()(Eigen::all, moving);
  directions = (directions.array().colwise() / rms).matrix()(moving, Eigen::all).eval();
  const VectorXd weights = 2.0 * fit_scales(with_constant, E).head(std::ssize(moving)).array() / sd(moving);
  return {directions, weights, weights.dot(mean(moving).matrix())};
}

FoundNoiseFactor find_noise_factor(const Recording& all, const LinearStructure& structure, Index folds,
                                   std::uint64_t seed) {
  constexpr Index most_transitions = 20'000;
  FoundNoiseFactor found;
  if (all.quantum.size() > 0 || folds < 2) return found;
  const std::optional<Recording> part = learning_part(all, most_transitions, seed);
  const Recording training = training_part(part ? *part : all);
  // The runs that chose the factor gain more than left-out runs would. If even the runs that chose it gain too little,
  // the factor is rejected without cross-validation.
  const MatrixXd seen = gains(training, training, structure);
  found.gain = mean_gain(seen).mean;
  const std::vector<ValidationSplit> splits = validation_splits(training, folds);
  if (!is_worth_it(mean_gain(seen), seen.col(1)) || splits.empty()) return found;
  std::vector<MatrixXd> of_splits(splits.size());
  tbb::parallel_for(std::size_t{0}, splits.size(),
                    [&](std::size_t s) { of_splits[s] = gains(splits[s].training, splits[s].left_out, structure); });
  MatrixXd left_out(0, 2);
  for (const MatrixXd& of_split : of_splits) {
    left_out.conservativeResize(left_out.rows() + of_split.rows(), Eigen::NoChange);
    left_out.bottomRows(of_split.rows()) = of_split;
  }
  const PairedLoss gain = mean_gain(left_out);
  if (is_worth_it(gain, left_out.col(1))) found.factor = fit_noise_factor(training, structure);
  return {std::move(found.factor), gain.mean, gain.standard_error};
}

}  // namespace modebank
