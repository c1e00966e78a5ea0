// One motion whose noise switches between levels: noise_only, one_motion.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/sample_quantile.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/fit/robust_regression.hpp"

namespace modebank {
namespace {

constexpr Index noise_only_levels = 8;  // method: section 6, also for the other constants here
constexpr double lowest_quantile = 0.30;
constexpr double highest_quantile = 0.997;
constexpr std::array<double, 4> stays{0.7, 0.8, 0.9, 0.95};

/// Variances in geometric steps between the squared quantiles of |r|; positive even if most residuals are zero.
Eigen::VectorXd noise_scales(const Eigen::VectorXd& r, Index levels) {
  std::vector<double> sizes(r.size());
  Eigen::VectorXd::Map(sizes.data(), r.size()) = r.cwiseAbs();
  std::sort(sizes.begin(), sizes.end());
  const double low = sample_quantile(sizes, lowest_quantile), high = sample_quantile(sizes, highest_quantile);
  const double mean_square = r.squaredNorm() / static_cast<double>(r.size());
  const double floor = rounding_share * positive_variance(mean_square);
  if (levels == 1) return Eigen::VectorXd::Constant(1, std::max(mean_square, floor));
  const double log_low = std::log(std::max(low * low, floor)), log_high = std::log(std::max(high * high, floor));
  return Eigen::VectorXd::LinSpaced(levels, log_low, log_high).array().exp();
}

/// levels x n, one column per state: row j is the diagonal of mode j's Q.
Eigen::MatrixXd noise_scales_per_state(const Eigen::MatrixXd& residuals, Index levels) {
  Eigen::MatrixXd variances(levels, residuals.cols());
  for (Index i = 0; i < residuals.cols(); ++i) variances.col(i) = noise_scales(residuals.col(i), levels);
  return variances;
}

/// q x n, as in RobustRegression.
struct Regression {
  Eigen::MatrixXd coefficients, standard_error;
};

/// Huber's regression, or least squares if states are rounded. (With rounding many values repeat. Huber's scale is then
/// zero, and x[k+1] = x[k] looks exact.)
Regression regression(const Recording& recording, const LinearStructure& structure, const Transitions& transitions) {
  if (recording.quantum.size() == 0) {
    const RobustRegression fit = huber_regression(transitions);
    return {fit.coefficients, fit.standard_error};
  }
  const GlobalModel fit = fit_global(recording, structure);
  const Index q = transitions.regressors.cols(), n = transitions.increments.cols();
  return {fit.theta.reshaped(q, n), fit.covariance.diagonal().cwiseSqrt().reshaped(q, n)};
}

/// Sets the `stay` that is most likely on the training runs (the smallest of equals); returns the log-likelihood.
double choose_stay(Bank& bank, const Recording& recording) {
  Bank candidate = bank;
  double best = not_a_number;
  for (const double stay : stays) {
    set_mode_sequence(candidate, TransitionMatrix::sticky(bank.mode_count(), stay));
    const double likelihood = training_log_likelihood(candidate, recording, FilterOptions{});
    if (stay != stays.front() && !is_below(best, likelihood)) continue;
    best = likelihood;
    bank = candidate;
  }
  return best;
}

/// One motion with Huber's theta and this number of noise scales.
Bank with_noise_scales(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R,
                       Index levels, const NoiseFactor& factor) {
  Bank bank = bank_frame(recording, structure, R);
  bank.noise_factor = factor;
  Transitions transitions = stack_training(recording, structure);
  require_transitions(transitions.count() > 0);
  divide_by_noise(factor, structure, transitions);
  const Regression fit = regression(recording, structure, transitions);
  const Eigen::MatrixXd variances =
      noise_scales_per_state(transitions.increments - transitions.regressors * fit.coefficients, levels);
  const Index p = structure.parameters();
  for (Index j = 0; j < levels; ++j)
    bank.modes.push_back(make_mode(structure, fit.coefficients.reshaped(), variances.row(j).asDiagonal(),
                                   Eigen::MatrixXd::Zero(p, p), fit.standard_error.reshaped(),
                                   1.0 / static_cast<double>(levels)));
  choose_stay(bank, recording);
  return bank;
}

/// Improves theta and noise levels of rounded states by the filter's likelihood, whose R has the rounding. The search
/// starts from the residuals of rounded values, which include the rounding, too.
Bank beside_rounding(Bank bank, const Recording& recording) {
  FreeParameters free;
  // The runs do not determine some directions. These may have any unit, because nothing depends on them.
  free.theta_unit = bank.modes.front().standard_error.unaryExpr(
      [](double error) { return std::isnan(error) ? 1.0 : positive_variance(error); });
  free.transition = false;
  return maximise_likelihood({recording, FilterOptions{}, std::nullopt, true}, free, bank, {60, 1e-6}).bank;
}

}  // namespace

Bank learn_noise_only(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R,
                      const NoiseFactor& factor) {
  Bank bank = with_noise_scales(recording, structure, R, noise_only_levels, factor);
  return bank.is_quantised() ? beside_rounding(std::move(bank), recording) : bank;
}

Bank noise_only_beside(const Bank& baseline, bool of_linear_stage, const Recording& recording,
                       const LinearStructure& structure, const NoiseFactor& factor) {
  Bank exact = learn_noise_only(recording, structure, baseline.R, factor);
  if (!of_linear_stage || !factor.empty()) return exact;
  constexpr double lowest = 0.25, step = 2.0, least_share_of_R = 0.01;
  Bank bank = baseline;
  const Index n = baseline.structure.states;
  Mode mode = baseline.modes.front();
  mode.response = {};
  mode.weight = 1.0 / static_cast<double>(noise_only_levels);
  const Eigen::VectorXd Q = baseline.noise_variance().cwiseMax(least_share_of_R * baseline.R.diagonal());
  bank.modes.clear();
  for (Index j = 0; j < noise_only_levels; ++j) {
    mode.Q.diagonal().head(n) = lowest * std::pow(step, static_cast<double>(j)) * Q;
    bank.modes.push_back(mode);
  }
  const double likelihood = choose_stay(bank, recording);
  return training_log_likelihood(exact, recording, FilterOptions{}) > likelihood ? exact : bank;
}

namespace {

/// The fields of the windows that refinement of a linear model uses.
WindowFits linear_frame(const WindowFits& fits, const GlobalModel& global) {
  WindowFits frame;
  frame.structure = fits.structure;
  frame.length = fits.length;
  frame.step = fits.step;
  frame.global = global;
  // The prior of a motion model concerns other parameters.
  if (fits.model_parameters.empty()) frame.prior_sd = fits.prior_sd;
  return frame;
}

/// The frame with the noises and the transitions of `rival`, and one theta.
Bank with_noises_of(const Bank& rival, Bank frame, const GlobalModel& global) {
  const Index n = frame.structure.states, p = frame.structure.parameters();
  frame.modes.clear();
  for (const Mode& mode : rival.modes)
    frame.modes.push_back(make_mode(frame.structure, global.theta, mode.Q.topLeftCorner(n, n),
                                    Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p), mode.weight));
  set_mode_sequence(frame, rival.transition);
  return frame;
}

}  // namespace

std::vector<Bank> level_starts(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R,
                               Index most, double kept, const NoiseFactor& factor) {
  std::vector<Bank> starts;
  for (Index levels = most; levels >= 1; levels = static_cast<Index>(kept * static_cast<double>(levels)))
    starts.push_back(with_noise_scales(recording, structure, R, levels, factor));
  return starts;
}

Refinement learn_one_motion(const Recording& recording, const WindowFits& fits, const GlobalModel& global,
                            const Bank& rival, const Eigen::MatrixXd& R, Index most_levels,
                            const BankOptions& options) {
  RefineOptions em = options.em;
  em.one_theta = true;
  em.state_dependent_transition = options.transition == TransitionSource::logit;
  em.restarts = 0;  // random stretches differ in theta, but this model has one theta
  em.measurement_noise = em.measurement_noise && !options.measurement_variance;
  std::vector<Bank> starts =
      level_starts(recording, fits.structure, stated_or(options, R), most_levels, refine_tuning.modes_kept,
                   em.noise_by_input ? fit_noise_factor(recording, fits.structure) : NoiseFactor());
  if (rival.mode_count() > 1) starts.push_back(with_noises_of(rival, starts.front(), global));
  Refinement learned = refine_bank(recording, linear_frame(fits, global), starts, em, FilterOptions{});
  clear_unidentifiable(learned.bank, global.covariance);
  return learned;
}

}  // namespace modebank
