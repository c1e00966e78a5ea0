#include "filter/learn/refine/refine.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "filter/judge/evaluate.hpp"
#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/learn/refine/cross_validation.hpp"
#include "filter/step/motions.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/fit/horizon_fit.hpp"

namespace modebank {
namespace {

constexpr Index most_motions = 4;

/// The starts: banks of the mixture, and banks from random stretches of the runs, with the number of modes of the
/// mixture's first bank and, if requested, larger numbers.
std::vector<BankCandidate> all_starts(const RefineInput& in, const std::vector<Bank>& banks) {
  std::vector<BankCandidate> starts;
  for (const Bank& bank : banks) starts.push_back({"mixture", switching_model(bank)});
  const SwitchingPrior prior = in.prior(in.all);
  const Index fewest = banks.front().mode_count();
  Index modes = std::max(in.options.most_modes, fewest);
  while (modes > 1) {  // all starts with one mode end in the same maximum
    for (Index i = 0; i < in.options.restarts; ++i)
      starts.push_back({fmt::format("stretches {}", i + 1),
                        start_from_stretches(in.all.transitions, prior, modes, in.fits.length, in.options.seed, i)});
    if (modes == fewest) break;
    modes = std::max(static_cast<Index>(modes_kept * static_cast<double>(modes)), fewest);
  }
  return starts;
}

/// Chooses the start and the number of iterations, then motions and ties.
CrossValidation cross_validate(RefineInput& in, const std::vector<Bank>& banks) {
  CrossValidation validation(in);
  if (!validation.possible()) in.Q_transitions = 1.0;  // unit information
  validation.consider(all_starts(in, banks));
  if (!validation.possible()) return validation;
  const bool one_motion = !banks.front().motion.empty();
  if (in.unknown_states || !one_motion) consider_motions(in, one_motion ? 1 : most_motions, validation);
  consider_ties(in, validation);
  return validation;
}

SingleModel single_model(const Recording& recording, const Bank& frame) {
  const LinearStructure& s = frame.structure;
  const ArmaxOrder order{false, s.state_lags, s.input_lags, s.state_lags, s.intercept};
  const std::optional<Bank> single = learn_armax(recording, {order, s.input_delay.by_input(s.inputs)}, std::nullopt);
  if (!single) return {frame.R.diagonal()};
  return {single->R.diagonal().cwiseMax(frame.R.diagonal()), response_samples(*single)};
}

/// The bank with this theta in all modes. Q and T maximise the likelihood of the runs.
Bank with_theta(const Recording& recording, const RefineOptions& options, const Eigen::VectorXd& theta, Bank bank) {
  for (Mode& mode : bank.modes) {
    mode.model = unpack(bank.structure, theta);
    mode.standard_error.setConstant(not_a_number);
    mode.Q_standard_error.resize(0, 0);
  }
  bank.R_standard_error.resize(0, 0);
  bank.transition_standard_error.resize(0, 0);
  const SwitchingPrior prior = switching_prior(gather_training_transitions(recording, bank.structure),
                                               fit_global(recording, bank.structure), {}, 1.0);
  FreeParameters free;
  free.transition = bank.mode_count() > 1;
  return maximise_likelihood({recording, {}, prior}, free, bank, {options.max_iterations, options.tolerance}).bank;
}

/// Summed squares of the errors of a free run after `measured` samples, n.
Eigen::VectorXd free_run_squares(const Bank& bank, const Eigen::VectorXd& theta, const Trajectory& run,
                                 Index measured) {
  const Index origin = std::max(measured - 1, bank.structure.first_transition());
  if (run.transitions() <= origin) return Eigen::VectorXd::Zero(bank.structure.states);
  const Eigen::MatrixXd errors = errors_ahead(bank.structure, theta, run, origin, run.transitions());
  return run.state.rightCols(errors.cols()).array().isNaN().select(0.0, errors).rowwise().squaredNorm();
}

/// The bank of the fit with standard errors, and with weights, the filter's mean probabilities.
Bank with_errors(const RefineInput& in, const Fit& fit) {
  Bank bank = fit.learned.bank;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(bank.mode_count());
  for (const Trajectory& run : in.all.recording.runs)
    if (run.role == Role::train) sum += evaluate_run(bank, run, {}).mode_probability.rowwise().sum();
  for (Index j = 0; j < sum.size(); ++j) bank.modes[j].weight = sum(j) / sum.sum();
  const ModePosterior posterior = smooth_modes(in.all.transitions, switching_model(bank));
  bank = with_complete_errors(in.all.transitions, posterior, fit.learned.prior, std::move(bank));
  return with_standard_errors({in.all.recording, {}, fit.learned.prior},
                              all_parameters(bank, !fit.exact() && in.estimates_R(), in.least_R()), bank);
}

}  // namespace

Refinement refine_bank(const Recording& recording, const WindowFits& fits, const std::vector<Bank>& banks,
                       const RefineOptions& options, const FilterOptions& filter) {
  if (banks.empty()) throw std::invalid_argument("refinement needs at least one bank");
  if (!banks.front().motion_parameters.empty())
    throw std::invalid_argument("a bank of the motion model " + banks.front().model +
                                " cannot be refined; expected linear or varx");
  Bank frame = banks.front();
  // R of a start is not kept: the fit treats states as measured exactly, so R is already included in Q. Only the
  // variance of rounding stays.
  if (options.measurement_noise) frame.R = frame.rounding_variance().asDiagonal();
  RefineInput in{
      fits, options, filter, {recording, gather_training_transitions(recording, frame.structure), fits.global}, frame};
  if (options.measurement_noise || !frame.R.isZero(0.0)) {
    in.single = single_model(recording, frame);
    // Many lags can replace R, and gradients of the likelihood ignore that transitions depend on the state.
    in.unknown_states =
        frame.structure.state_lags <= most_lags_beside_R && !options.state_dependent_transition &&
        filter.variant == FilterVariant::imm &&
        (!options.measurement_noise || has_noisy_sensor(in.single.R, fits.global.noise_variance() - in.single.R));
  }
  const CrossValidation validation = cross_validate(in, banks);
  Refinement result;
  result.start = banks.front();
  Fit chosen = validation.chosen();
  if (options.state_dependent_transition)
    if (std::optional<Fit> with_logit = choose_logit(in, validation, result.switching)) chosen = std::move(*with_logit);
  result.candidates = validation.table(chosen.candidate.row);
  if (chosen.exact()) {
    SwitchingFit fit = fit_training_runs(in, chosen.candidate);
    if (Eigen::MatrixXd& weights = fit.model.logit.weights; weights.size() > 0)
      weights.rowwise() -= weights.colwise().mean().eval();  // does not change probabilities
    result.objective = fit.objective;
    chosen.learned.prior = in.prior(in.all, chosen.candidate.logit_width);
    chosen.learned.bank = with_modes(in.frame, fit.model);
    chosen.learned.bank.screened = fit.screened;
  }
  chosen = fit_with_measurement_noise(in, validation, std::move(chosen), result.measurement);
  result.bank = with_errors(in, chosen);
  result.of_splits = std::move(chosen.of_splits);
  return result;
}

bool fit_horizon(const Recording& recording, const RefineOptions& options, Index horizon, Index measured,
                 Refinement& one_motion) {
  const std::vector<ValidationSplit> splits = validation_splits(recording, options.folds);
  if (splits.empty() || splits.size() != one_motion.of_splits.size()) return false;
  std::vector<Eigen::VectorXd> thetas(splits.size());
  tbb::parallel_for(std::size_t{0}, splits.size(), [&](std::size_t s) {
    const Bank& bank = one_motion.of_splits[s];
    thetas[s] = fit_over_horizon(splits[s].training, bank.structure, bank.theta(0), horizon);
  });
  const LinearStructure& structure = one_motion.bank.structure;
  Index runs = 0;
  for (const ValidationSplit& split : splits) runs += std::ssize(split.left_out.runs);
  Eigen::MatrixXd before(structure.states, runs), after = before;  // summed squares, a column per left-out run
  Eigen::VectorXd samples(runs);
  for (std::size_t s = splits.size(); s-- > 0;)
    for (const Trajectory& run : splits[s].left_out.runs) {
      const Bank& bank = one_motion.of_splits[s];
      before.col(--runs) = free_run_squares(bank, bank.theta(0), run, measured);
      after.col(runs) = free_run_squares(bank, thetas[s], run, measured);
      samples(runs) = static_cast<double>(run.transitions());
    }
  // In units of the errors before the fit, all signals have equal weight and gains are roughly in nats.
  const Eigen::RowVectorXd unit = before.rowwise().sum().transpose() / samples.sum();
  const auto score = [&](const Eigen::MatrixXd& squares) -> Eigen::VectorXd {
    return -0.5 * (unit.cwiseInverse() * squares).transpose();
  };
  if (!is_worth_it(paired_loss(score(after), score(before), samples), samples)) return false;
  one_motion.bank = with_theta(
      recording, options, fit_over_horizon(recording, structure, one_motion.bank.theta(0), horizon), one_motion.bank);
  tbb::parallel_for(std::size_t{0}, splits.size(), [&](std::size_t s) {
    one_motion.of_splits[s] = with_theta(splits[s].training, options, thetas[s], one_motion.of_splits[s]);
  });
  return true;
}

}  // namespace modebank
