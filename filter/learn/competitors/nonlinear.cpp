#include <algorithm>
#include <utility>
#include <vector>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/refine/cross_validation.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/stretch.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index most_levels = 4;  // number of levels besides the wide one
constexpr std::ptrdiff_t most_em_iterations = 35;
// The results change little with these values. Tested were factors of 4 to 25, shares of 0.001 to 0.01 and stays of 0.5
// to 0.98. Mean held-out scores of eleven nonlinear motions changed by less than 0.016 nats.
constexpr double wide_factor = 9.0;  // factor on the widest level's variance
constexpr double wide_share = 0.01;  // probability that a step enters the wide level
constexpr double wide_stay = 0.9;

/// A structure with all acting inputs as inputs without lags, followed by the terms.
LinearStructure with_known_terms(const LinearStructure& s, const MotionTerms& terms) {
  return {s.states, s.acting_inputs() + terms.count(), s.intercept, s.state_lags};
}

/// Replaces columns that are not finite by the last known values; zeros before the first.
void fill_unknown(MatrixXd& columns) {
  for (Index k = 0; k < columns.cols(); ++k) {
    if (columns.col(k).allFinite()) continue;
    if (k > 0)
      columns.col(k) = columns.col(k - 1);
    else
      columns.col(k).setZero();
  }
}

/// The run from the sample at which filters with lags start. Each sample has the acting inputs and the terms of its
/// transition.
Trajectory with_known_terms(const Trajectory& run, const LinearStructure& s, const MotionTerms& terms) {
  const Index first = s.first_transition() - (s.state_lags - 1);
  Trajectory known = stretch(run, first, run.samples() - first);
  const MatrixXd phi = stack_transitions(run, first, known.transitions(), s).regressors;
  known.input.resize(s.acting_inputs() + terms.count(), known.samples());
  known.input.leftCols(phi.rows()).topRows(s.acting_inputs()) =
      phi.middleCols(s.dimension(), s.acting_inputs()).transpose();
  known.input.leftCols(phi.rows()).bottomRows(terms.count()) = term_columns(terms, phi).transpose();
  for (Index k = 0; k < phi.rows(); ++k)
    if (!phi.row(k).allFinite()) known.input.col(k).setConstant(not_a_number);
  known.input.rightCols(1).setConstant(not_a_number);  // the value has no effect
  fill_unknown(known.input);
  return known;
}

Recording with_known_terms(const Recording& recording, const LinearStructure& s, const MotionTerms& terms) {
  Recording known{recording.states, {}, {}, recording.quantum};
  known.inputs.resize(static_cast<std::size_t>(s.acting_inputs() + terms.count()));
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train && run.transitions() > s.first_transition())
      known.runs.push_back(with_known_terms(run, s, terms));
  return known;
}

/// Parameters of the terms and of the linear regressors, separated equation by equation.
struct SplitParameters {
  VectorXd linear;
  MatrixXd bend;
};

SplitParameters split(const VectorXd& all, const LinearStructure& s, Index terms) {
  const Index before = s.dimension() + s.acting_inputs(), wide = s.regressors() + terms;
  SplitParameters parts{VectorXd(s.parameters()), MatrixXd(s.states, terms)};
  for (Index i = 0; i < s.states; ++i) {
    parts.linear.segment(i * s.regressors(), before) = all.segment(i * wide, before);
    if (s.intercept) parts.linear((i + 1) * s.regressors() - 1) = all((i + 1) * wide - 1);
    parts.bend.row(i) = all.segment(i * wide + before, terms).transpose();
  }
  return parts;
}

/// The factor for a bank that has the terms as further inputs. The factor does not depend on the terms.
NoiseFactor of_known(NoiseFactor factor, const MotionTerms& terms) {
  if (factor.empty()) return factor;
  const Index before = factor.directions.cols();
  factor.directions.conservativeResize(Eigen::NoChange, before + terms.count());
  factor.directions.rightCols(terms.count()).setZero();
  return factor;
}

Bank with_terms(Bank known, const Recording& recording, const LinearStructure& s, const MotionTerms& terms,
                const NoiseFactor& factor) {
  const Bank frame = bank_frame(recording, s, known.R);
  std::vector<Mode> modes;
  for (Index k = 0; k < known.mode_count(); ++k) {
    const Mode& of = known.modes[static_cast<std::size_t>(k)];
    const SplitParameters theta = split(known.theta(k), s, terms.count());
    const bool errors = of.standard_error.size() == known.structure.parameters();
    const SplitParameters error = errors ? split(of.standard_error, s, terms.count()) : SplitParameters();
    Mode mode = make_mode(s, theta.linear, of.Q.topLeftCorner(s.states, s.states),
                          MatrixXd::Zero(s.parameters(), s.parameters()), error.linear, of.weight);
    mode.Q_standard_error = of.Q_standard_error;
    mode.bend = theta.bend;
    mode.bend_standard_error = error.bend;
    modes.push_back(std::move(mode));
  }
  known.modes = std::move(modes);
  known.model = s.lagged() ? "varx" : "linear";
  known.structure = s;
  known.terms = terms;
  known.noise_factor = factor;
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
  const Index K = bank.mode_count();
  const auto widest = std::max_element(bank.modes.begin(), bank.modes.end(),
                                       [](const Mode& a, const Mode& b) { return a.Q.trace() < b.Q.trace(); });
  Mode wide = *widest;
  wide.Q *= wide_factor;
  wide.Q_standard_error.setConstant(not_a_number);
  wide.weight = wide_share;
  for (Mode& mode : bank.modes) mode.weight *= 1.0 - wide_share;
  MatrixXd T(K + 1, K + 1);
  T.topLeftCorner(K, K) = (1.0 - wide_share) * bank.transition.matrix();
  T.col(K).head(K).setConstant(wide_share);
  T.row(K).head(K).setConstant((1.0 - wide_stay) / static_cast<double>(K));
  T(K, K) = wide_stay;
  VectorXd initial(K + 1);
  initial << (1.0 - wide_share) * bank.initial_probability, wide_share;
  bank.modes.push_back(std::move(wide));
  bank.transition = TransitionMatrix(T);
  bank.initial_probability = initial;
  bank.transition_standard_error.resize(0, 0);
}

}  // namespace

Bank learn_nonlinear(const Recording& recording, const LinearStructure& structure, const MotionTerms& terms,
                     const RefineOptions& options) {
  const Recording known = with_known_terms(recording, structure, terms);
  require_transitions(!known.runs.empty());
  WindowFits frame;
  frame.structure = with_known_terms(structure, terms);
  frame.global = fit_global(known, frame.structure);
  RefineOptions em = options;
  em.one_theta = true;
  em.state_dependent_transition = false;
  em.restarts = 0;
  em.measurement_noise = false;
  em.noise_by_input = false;  // the starts have the factor; one without the left-out runs needs the terms
  em.max_iterations = std::min(em.max_iterations, most_em_iterations);
  const MatrixXd R = MatrixXd::Zero(structure.states, structure.states);
  const NoiseFactor factor = options.noise_by_input ? fit_noise_factor(recording, structure, terms) : NoiseFactor();
  Bank bank = refine_bank(known, frame,
                          level_starts(known, frame.structure, R, most_levels, refine_tuning.modes_kept,
                                       of_known(factor, terms)),
                          em, FilterOptions{})
                  .bank;
  add_wide_level(bank);
  return with_terms(std::move(bank), recording, structure, terms, factor);
}

}  // namespace modebank
