// One motion whose noise switches between levels: noise_only, one_motion, nonlinear.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "ident/base/sample_quantile.hpp"
#include "ident/data/stretch.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/fit/robust_regression.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {
namespace {

constexpr Index noise_only_levels = 8;  // method: section 6, also for the other constants here

/// Variances in geometric steps between the squared quantiles of |r|; positive even if most residuals are zero.
Eigen::VectorXd noise_scales(const Eigen::VectorXd& r, Index levels) {
  constexpr double lowest_quantile = 0.30, highest_quantile = 0.997;
  std::vector<double> sizes(r.begin(), r.end());
  for (double& size : sizes) size = std::abs(size);
  std::ranges::sort(sizes);
  const double low = sample_quantile(sizes, lowest_quantile), high = sample_quantile(sizes, highest_quantile);
  const double mean_square = r.squaredNorm() / static_cast<double>(r.size());
  const double floor = rounding_share * positive_variance(mean_square);
  if (levels == 1) return Eigen::VectorXd::Constant(1, std::max(mean_square, floor));
  const double log_low = std::log(std::max(low * low, floor)), log_high = std::log(std::max(high * high, floor));
  return Eigen::VectorXd::LinSpaced(levels, log_low, log_high).array().exp();
}

/// Sets the `stay` that is most likely on the training runs (the smallest of equals); returns the log-likelihood.
double choose_stay(Bank& bank, const Recording& recording) {
  constexpr std::array stays{0.7, 0.8, 0.9, 0.95};
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

/// One motion with this number of noise scales. theta is Huber's, or that of least squares if states are rounded: then
/// many values repeat, Huber's scale is zero, and x[k+1] = x[k] looks exact.
Bank with_noise_scales(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R,
                       Index levels) {
  Bank bank = bank_frame(recording, structure, R);
  bank.motion.assign(static_cast<std::size_t>(levels), 0);
  const Transitions transitions = stack_training(recording, structure);
  require_transitions(transitions.count() > 0);
  RobustRegression fit;
  if (recording.quantum.size() > 0) {
    const GlobalModel global = fit_global(recording, structure);
    fit.coefficients = coefficients(structure, global.theta);
    fit.standard_error = coefficients(structure, global.covariance.diagonal().cwiseSqrt());
  } else {
    fit = huber_regression(transitions);
  }
  const Eigen::MatrixXd residuals = transitions.increments - transitions.regressors * fit.coefficients;
  Eigen::MatrixXd variances(levels, structure.states);
  for (Index i = 0; i < structure.states; ++i) variances.col(i) = noise_scales(residuals.col(i), levels);
  const Index p = structure.parameters();
  for (Index j = 0; j < levels; ++j)
    bank.modes.push_back(make_mode(structure, fit.coefficients.reshaped(), variances.row(j).asDiagonal(),
                                   Eigen::MatrixXd::Zero(p, p), fit.standard_error.reshaped(),
                                   1.0 / static_cast<double>(levels)));
  choose_stay(bank, recording);
  return bank;
}

/// Starting banks with one theta: the first has `most` noise levels, the next three quarters of that, and so on.
std::vector<Bank> level_starts(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R,
                               Index most) {
  std::vector<Bank> starts;
  for (Index levels = most; levels >= 1; levels = static_cast<Index>(modes_kept * static_cast<double>(levels)))
    starts.push_back(with_noise_scales(recording, structure, R, levels));
  return starts;
}

}  // namespace

Bank learn_noise_only(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R) {
  const Bank bank = with_noise_scales(recording, structure, R, noise_only_levels);
  if (!bank.is_quantised()) return bank;
  // The residuals of rounded values include the rounding, and so does R of the filter: its likelihood decides.
  FreeParameters free;
  // The runs do not determine some directions. These may have any unit, because nothing depends on them.
  free.theta_unit = bank.modes.front().standard_error.unaryExpr(
      [](double error) { return std::isnan(error) ? 1.0 : positive_variance(error); });
  free.transition = false;
  return maximise_likelihood({recording, FilterOptions{}, std::nullopt}, free, bank, {60, 1e-6}).bank;
}

Bank noise_only_beside(const Bank& baseline, bool of_linear_stage, const Recording& recording,
                       const LinearStructure& structure) {
  Bank exact = learn_noise_only(recording, structure, baseline.R);
  if (!of_linear_stage) return exact;
  constexpr double lowest = 0.25, step = 2.0, least_share_of_R = 0.01;
  Bank bank = baseline;
  const Index n = baseline.structure.states;
  Mode mode = baseline.modes.front();
  mode.response = {};
  mode.weight = 1.0 / static_cast<double>(noise_only_levels);
  const Eigen::VectorXd Q = baseline.noise_variance().cwiseMax(least_share_of_R * baseline.R.diagonal());
  bank.modes.clear();
  bank.motion.assign(noise_only_levels, 0);
  for (Index j = 0; j < noise_only_levels; ++j) {
    mode.Q.diagonal().head(n) = lowest * std::pow(step, static_cast<double>(j)) * Q;
    bank.modes.push_back(mode);
  }
  const double likelihood = choose_stay(bank, recording);
  return training_log_likelihood(exact, recording, FilterOptions{}) > likelihood ? exact : bank;
}

Refinement learn_one_motion(const Recording& recording, const WindowFits& frame, const Bank& rival,
                            const Eigen::MatrixXd& R, Index most_levels, const BankOptions& options) {
  RefineOptions em = options.em;
  em.state_dependent_transition = options.transition == TransitionSource::logit;
  em.restarts = 0;  // random stretches differ in theta, but this model has one theta
  em.measurement_noise = em.measurement_noise && !options.measurement_variance;
  const LinearStructure& structure = frame.structure;
  std::vector<Bank> starts = level_starts(recording, structure, stated_or(options, R), most_levels);
  if (rival.mode_count() > 1) {
    Bank start = starts.front();
    const Index n = structure.states, p = structure.parameters();
    start.modes.clear();
    start.motion.assign(rival.modes.size(), 0);
    for (const Mode& mode : rival.modes)
      start.modes.push_back(make_mode(structure, frame.global.theta, mode.Q.topLeftCorner(n, n),
                                      Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p), mode.weight));
    set_mode_sequence(start, rival.transition);
    starts.push_back(std::move(start));
  }
  Refinement learned = refine_bank(recording, frame, starts, em, FilterOptions{});
  clear_unidentifiable(learned.bank, frame.global.covariance);
  return learned;
}

namespace {

/// The training runs from the samples at which filters with lags start. Inputs, without lags, are the acting inputs of
/// `s` followed by the terms of the transition. Where a regressor is missing they are the last known ones.
Recording with_known_terms(const Recording& recording, const LinearStructure& s, const MotionTerms& terms) {
  const Index first = s.first_transition() - (s.state_lags - 1), acting = s.acting_inputs();
  Recording known{recording.states, {}, {}, recording.quantum};
  known.inputs.resize(static_cast<std::size_t>(acting + terms.count()));
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train || run.transitions() <= s.first_transition()) continue;
    Trajectory& of = known.runs.emplace_back(stretch(run, first, run.samples() - first));
    const Eigen::MatrixXd phi = stack_transitions(run, first, of.transitions(), s).regressors;
    Eigen::MatrixXd inputs(phi.rows(), acting + terms.count());
    inputs << phi.middleCols(s.dimension(), acting), term_columns(terms, phi);
    of.input.setZero(inputs.cols(), of.samples());
    for (Index k = 0; k < of.samples(); ++k) {  // those of the last sample have no effect
      if (k < phi.rows() && phi.row(k).allFinite())
        of.input.col(k) = inputs.row(k).transpose();
      else if (k > 0)
        of.input.col(k) = of.input.col(k - 1);
    }
  }
  return known;
}

/// The bank of `s` with terms, from one whose inputs are those of with_known_terms.
Bank with_terms(Bank known, const Recording& recording, const LinearStructure& s, const MotionTerms& terms) {
  const Index before = s.dimension() + s.acting_inputs(), wide = known.structure.regressors();
  std::vector<Index> linear(static_cast<std::size_t>(before));
  std::iota(linear.begin(), linear.end(), Index{0});
  if (s.intercept) linear.push_back(wide - 1);
  // Equation by equation: of the linear regressors (p) and of the terms (n x T).
  const auto split = [&](const Eigen::VectorXd& all) {
    const Eigen::MatrixXd rows = all.reshaped(wide, s.states);
    return std::pair<Eigen::VectorXd, Eigen::MatrixXd>(rows(linear, Eigen::all).reshaped(),
                                                       rows.middleRows(before, terms.count()).transpose());
  };
  for (Mode& mode : known.modes) {
    const auto [theta, bend] = split(pack(known.structure, mode.model));
    const bool errors = mode.standard_error.size() == known.structure.parameters();
    const auto [error, bend_error] =
        errors ? split(mode.standard_error) : std::pair<Eigen::VectorXd, Eigen::MatrixXd>();
    Mode with = make_mode(s, theta, mode.Q.topLeftCorner(s.states, s.states),
                          Eigen::MatrixXd::Zero(s.parameters(), s.parameters()), error, mode.weight);
    with.Q_standard_error = mode.Q_standard_error;
    with.bend = bend;
    with.bend_standard_error = bend_error;
    mode = std::move(with);
  }
  const Bank frame = bank_frame(recording, s, known.R);
  known.model = s.lagged() ? "varx" : "linear";
  known.structure = s;
  known.terms = terms;
  known.C = frame.C;
  known.state_names = frame.state_names;
  known.input_names = frame.input_names;
  known.dt_s = frame.dt_s;
  return known;
}

/// Adds one more noise level, which the training runs do not require. If inputs move differently later, the errors of
/// terms may be several times those in training. Without such a level, a bank gives these errors almost no density. On
/// fourteen nonlinear systems (two seeds of seven kinds) the mean gain is 0.13 nats per held-out sample (backlash: 0.73
/// and 1.07). Without large errors the loss is 0.007 nats. With such a level noise_only and one_motion lose 0.009 nats,
/// even if the pole differs by run, so they have none.
void add_wide_level(Bank& bank) {
  // The results change little with these values. Tested were factors of 4 to 25, shares of 0.001 to 0.01 and stays of
  // 0.5 to 0.98. Mean held-out scores of eleven nonlinear motions changed by less than 0.016 nats.
  constexpr double factor = 9.0;  // on the widest level's variance
  constexpr double share = 0.01;  // probability that a step enters the wide level
  constexpr double stay = 0.9;
  const Index K = bank.mode_count();
  const auto widest = std::max_element(bank.modes.begin(), bank.modes.end(),
                                       [](const Mode& a, const Mode& b) { return a.Q.trace() < b.Q.trace(); });
  Mode wide = *widest;
  wide.Q *= factor;
  wide.Q_standard_error.setConstant(not_a_number);
  wide.weight = share;
  for (Mode& mode : bank.modes) mode.weight *= 1.0 - share;
  Eigen::MatrixXd T(K + 1, K + 1);
  T.topLeftCorner(K, K) = (1.0 - share) * bank.transition.matrix();
  T.col(K).head(K).setConstant(share);
  T.row(K).head(K).setConstant((1.0 - stay) / static_cast<double>(K));
  T(K, K) = stay;
  Eigen::VectorXd initial(K + 1);
  initial << (1.0 - share) * bank.initial_probability, share;
  bank.modes.push_back(std::move(wide));
  bank.motion.push_back(0);
  bank.transition = TransitionMatrix(T);
  bank.initial_probability = initial;
  bank.transition_standard_error.resize(0, 0);
}

}  // namespace

Bank learn_nonlinear(const Recording& recording, const LinearStructure& structure, const MotionTerms& terms,
                     const RefineOptions& options) {
  constexpr Index most_levels = 4;  // besides the wide one
  constexpr std::ptrdiff_t most_em_iterations = 35;
  const Recording known = with_known_terms(recording, structure, terms);
  require_transitions(!known.runs.empty());
  WindowFits frame;
  frame.structure = {structure.states, std::ssize(known.inputs), structure.intercept, structure.state_lags};
  frame.global = fit_global(known, frame.structure);
  RefineOptions em = options;
  em.state_dependent_transition = false;
  em.restarts = 0;
  em.measurement_noise = false;
  em.max_iterations = std::min(em.max_iterations, most_em_iterations);
  const std::vector<Bank> starts =
      level_starts(known, frame.structure, Eigen::MatrixXd::Zero(structure.states, structure.states), most_levels);
  Bank bank = refine_bank(known, frame, starts, em, FilterOptions{}).bank;
  add_wide_level(bank);
  return with_terms(std::move(bank), recording, structure, terms);
}

}  // namespace modebank
