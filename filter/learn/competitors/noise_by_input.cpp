#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/left_out/rule.hpp"
#include "filter/learn/switching/em.hpp"
#include "filter/learn/switching/regression.hpp"
#include "filter/learn/tuning.hpp"
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

constexpr Index most_transitions = 20'000;
constexpr double nu = 5.0;                // degrees of freedom of the residuals' Student t
constexpr double ridge = 4.0;             // information of one sample about each standardised logarithm
constexpr double largest_exponent = 6.0;  // limit of the exponent of a scale during the search
constexpr int most_scoring_steps = 25;
constexpr std::array<double, 4> noise_levels{1.0 / 16.0, 0.25, 1.0, 4.0};  // smallest noise at the start, as a share of
                                                                           // the residuals' variance
constexpr double start_stay = 0.9;
constexpr int most_em_steps = 15;

/// Directions over [z; v] that noise may depend on, one per row. `coefficients`: q x n.
MatrixXd candidate_directions(const LinearStructure& s, const MatrixXd& coefficients) {
  const Index n = s.dimension(), m = s.acting_inputs();
  const bool changes = s.input_lags > 1, sums = m > 1;  // with a single input, the sum of the inputs is the same
                                                        // direction
  MatrixXd D = MatrixXd::Zero(s.states + s.inputs + (changes ? s.inputs : 0) + (sums ? s.states : 0), n + m);
  Index row = 0;
  for (Index i = 0; i < s.states; ++i) D(row++, i) = 1.0;
  for (Index i = 0; i < s.inputs; ++i) D(row++, n + i) = 1.0;
  for (Index i = 0; changes && i < s.inputs; ++i) {
    D(row, n + i) = 1.0;
    D(row++, n + s.inputs + i) = -1.0;
  }
  for (Index o = 0; sums && o < s.states; ++o) D.row(row++).tail(m) = coefficients.col(o).segment(n, m).transpose();
  return D;
}

/// Residuals divided by a robust scale of each column; columns of zeros are dropped.
MatrixXd standardised(const MatrixXd& residuals) {
  std::vector<Index> kept;
  MatrixXd E = residuals;
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
  VectorXd g = VectorXd::Zero(z.cols());
  const double per_sample = 2.0 * nu / (nu + 3.0) * static_cast<double>(E.cols());
  MatrixXd information = per_sample * z.transpose() * z;
  information.diagonal().array() += ridge;
  const Cholesky factor(information);
  for (int step = 0; step < most_scoring_steps && factor.definite(); ++step) {
    const Eigen::ArrayXd inverse = (-2.0 * (z * g).array().max(-largest_exponent).min(largest_exponent)).exp();
    Eigen::ArrayXd excess = Eigen::ArrayXd::Zero(E.rows());
    for (Index i = 0; i < E.cols(); ++i) {
      const Eigen::ArrayXd squares = E.col(i).array().square() * inverse;
      excess += (nu + 1.0) * squares / (nu + squares) - 1.0;
    }
    const VectorXd change =
        factor.solve(VectorXd(z.transpose() * excess.matrix() - ridge * g)).cwiseMax(-1.0).cwiseMin(1.0);
    g += change;
    if (change.cwiseAbs().maxCoeff() < 1e-6) break;
  }
  return g;
}

/// The rows with the terms as additional regressors.
Transitions with_terms(Transitions rows, const MotionTerms& terms) {
  if (terms.empty()) return rows;
  const MatrixXd columns = term_columns(terms, rows.regressors);
  const Index q = rows.regressors.cols();
  rows.regressors.conservativeResize(Eigen::NoChange, q + columns.cols());
  rows.regressors.rightCols(columns.cols()) = columns;
  return rows;
}

/// One motion whose noise switches between levels, by expectation-maximisation. If noise is larger for a while, a
/// filter can follow it without an input. So the levels must be learned. With fixed levels, a factor seemed to gain
/// 0.15 nats per sample on DART's training runs.
SwitchingRegression switching_noise(const Recording& recording, const TrainingTransitions& transitions) {
  const GlobalModel global = fit_global(recording, transitions.structure);
  const SwitchingPrior prior = switching_prior(transitions, global, {}, refine_tuning.Q_transitions);
  SwitchingRegression model;
  model.theta = global.theta.replicate(1, std::ssize(noise_levels));
  for (const double level : noise_levels) model.Q.emplace_back(level * prior.noise);
  model.transition = TransitionMatrix::sticky(std::ssize(noise_levels), start_stay).matrix();
  model.initial = VectorXd::Constant(std::ssize(noise_levels), 1.0 / static_cast<double>(noise_levels.size()));
  ExpectationMaximisation em(transitions, prior, {.one_theta = true, .tolerance = 1e-4}, std::move(model));
  for (int i = 0; i < most_em_steps && !em.converged(); ++i) em.step();
  return em.model();
}

/// Per run: sum over the rows of `judged` of the log density that the factor adds. Also returns the number of these
/// rows.
std::pair<VectorXd, VectorXd> gains(const Recording& learned, const Recording& judged, const LinearStructure& s) {
  if (stack_training(judged, s).count() == 0) return {};
  const TrainingTransitions rows = gather_training_transitions(learned, s),
                            of_judged = gather_training_transitions(judged, s);
  const NoiseFactor factor = fit_noise_factor(learned, s);
  const VectorXd with_factor =
      predictive_log_densities(gather_training_transitions(judged, s, factor),
                               switching_noise(learned, gather_training_transitions(learned, s, factor)));
  const VectorXd without = predictive_log_densities(of_judged, switching_noise(learned, rows));
  return {sum_by_run(of_judged, with_factor - without), sum_by_run(of_judged, of_judged.usable)};
}

}  // namespace

NoiseFactor fit_noise_factor(const Recording& recording, const LinearStructure& s, const MotionTerms& terms) {
  const Transitions rows = with_terms(stack_training(recording, s), terms);
  require_transitions(rows.count() > 0);
  const MatrixXd theta = huber_regression(rows).coefficients;
  const MatrixXd E = standardised(rows.increments - rows.regressors * theta);
  if (E.cols() == 0) return {};
  const auto N = static_cast<double>(rows.count());
  NoiseFactor factor{candidate_directions(s, theta), {}, 0.0};
  MatrixXd z = rows.regressors.leftCols(factor.directions.cols()).rowwise() + s.acting_centre().transpose();
  z = (z * factor.directions.transpose()).cwiseAbs();
  std::vector<Index> moving;
  VectorXd mean(z.cols()), sd(z.cols());
  for (Index i = 0; i < z.cols(); ++i) {
    const double rms = std::sqrt(z.col(i).squaredNorm() / N);
    if (!(rms > 0.0)) continue;
    factor.directions.row(i) /= rms;
    z.col(i) = (z.col(i).array() / rms + NoiseFactor::softening).log();
    mean(i) = z.col(i).mean();
    z.col(i).array() -= mean(i);
    sd(i) = std::sqrt(z.col(i).squaredNorm() / N);
    if (!(sd(i) > 1e-6)) continue;
    z.col(i) /= sd(i);
    moving.push_back(i);
  }
  if (moving.empty()) return {};
  MatrixXd with_constant(z.rows(), std::ssize(moving) + 1);
  with_constant.leftCols(std::ssize(moving)) = z(Eigen::all, moving);
  with_constant.rightCols(1).setOnes();
  factor.directions = factor.directions(moving, Eigen::all).eval();
  factor.weights = 2.0 * fit_scales(with_constant, E).head(std::ssize(moving)).cwiseQuotient(sd(moving));
  factor.offset = factor.weights.dot(mean(moving));
  return factor;
}

FoundNoiseFactor find_noise_factor(const Recording& all, const LinearStructure& structure, Index folds,
                                   std::uint64_t seed) {
  FoundNoiseFactor found;
  if (all.quantum.size() > 0 || folds < 2) return found;
  const std::optional<Recording> part = learning_part(all, most_transitions, seed);
  const Recording training = training_part(part ? *part : all);
  // The runs that chose the factor gain more than left-out runs would. If even the runs that chose it gain too little,
  // the factor is rejected without cross-validation.
  const auto [of_all, rows] = gains(training, training, structure);
  const PairedLoss seen = paired_loss(of_all, VectorXd::Zero(of_all.size()), rows);
  found.gain = seen.mean;
  if (!is_worth_it(seen, rows)) return found;
  const std::vector<ValidationSplit> splits = validation_splits(training, folds);
  if (splits.empty()) return found;
  std::vector<std::pair<VectorXd, VectorXd>> left_out(splits.size());
  tbb::parallel_for(std::size_t{0}, splits.size(),
                    [&](std::size_t s) { left_out[s] = gains(splits[s].training, splits[s].left_out, structure); });
  std::vector<double> sums, samples;
  for (const auto& [gain, count] : left_out) {
    sums.insert(sums.end(), gain.begin(), gain.end());
    samples.insert(samples.end(), count.begin(), count.end());
  }
  const VectorXd sum = VectorXd::Map(sums.data(), std::ssize(sums)),
                 count = VectorXd::Map(samples.data(), std::ssize(samples));
  const PairedLoss gain = paired_loss(sum, VectorXd::Zero(sum.size()), count);
  found.gain = gain.mean;
  found.standard_error = gain.standard_error;
  if (is_worth_it(gain, count)) found.factor = fit_noise_factor(training, structure);
  return found;
}

}  // namespace modebank
