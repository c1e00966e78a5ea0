#include "filter/learn/refine/refine.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "filter/learn/likelihood/standard_errors.hpp"
#include "filter/learn/refine/cross_validation.hpp"
#include "filter/learn/refine/measurement_noise.hpp"
#include "filter/learn/switching/logit.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/fit/horizon_fit.hpp"

namespace modebank {
namespace {

/// The parts that are not refined. R of a start is not kept: the fit treats states as measured exactly, so R is already
/// included in Q. Only the variance of rounding stays.
Bank frame_of(const Bank& start, const RefineOptions& options) {
  Bank frame = start;
  if (options.measurement_noise) frame.R = frame.rounding_variance().asDiagonal();
  return frame;
}

/// Numbers of modes for starts from random stretches: the number in the mixture's bank and, if requested, larger
/// numbers.
std::vector<Index> stretch_modes(const RefineOptions& options, Index of_mixture) {
  std::vector<Index> counts;
  const double kept = refine_tuning.modes_kept;
  for (Index modes = options.most_modes; modes > of_mixture;
       modes = static_cast<Index>(kept * static_cast<double>(modes)))
    counts.push_back(modes);
  if (of_mixture > 1) counts.push_back(of_mixture);  // all starts with one mode end in the same maximum
  return counts;
}

/// The starts: banks of the mixture, and banks from random stretches of the runs.
std::vector<RefineStart> all_starts(const RefineInput& in, const std::vector<Bank>& banks, double Q_transitions) {
  std::vector<RefineStart> starts;
  for (const Bank& bank : banks) starts.push_back({"mixture", switching_model(bank), Q_transitions});
  const SwitchingPrior prior = in.prior(starts.front());
  for (const Index modes : stretch_modes(in.options, banks.front().mode_count()))
    for (Index i = 0; i < in.options.restarts; ++i)
      starts.push_back({fmt::format("stretches {}", i + 1),
                        start_from_stretches(in.transitions, prior, modes, in.fits.length, in.options.seed, i),
                        Q_transitions});
  return starts;
}

/// Chooses the start and the number of iterations first, then the strength of the prior on Q.
CrossValidation cross_validate(const RefineInput& in, const std::vector<Bank>& banks) {
  CrossValidation validation(in);
  const RefineTuning& tuning = refine_tuning;
  validation.consider(
      all_starts(in, banks, validation.possible() ? tuning.Q_transitions : tuning.Q_transitions_unvalidated));
  if (!validation.possible()) return validation;
  std::vector<RefineStart> starts(tuning.other_Q_transitions.size(), validation.chosen().start);
  for (std::size_t i = 0; i < starts.size(); ++i) starts[i].noise_transitions = tuning.other_Q_transitions[i];
  validation.consider(starts);
  return validation;
}

/// The fit as a bank, without standard errors. The weight of a mode is its share of the transitions.
Bank bank_of(const RefineInput& in, const TrainingFit& fit) {
  Bank bank = with_modes(in.frame, fit.model);
  bank.screened = fit.screened;
  const Eigen::VectorXd transitions =
      (fit.posterior.probability.transpose() * in.transitions.usable).cwiseMax(std::numeric_limits<double>::min());
  for (Index j = 0; j < transitions.size(); ++j)
    bank.modes[static_cast<std::size_t>(j)].weight = transitions(j) / transitions.sum();
  return bank;
}

/// The bank of the fit with standard errors, in the filter whose likelihood the fit maximises.
Bank with_errors(const RefineInput& in, const ModePosterior& posterior, const Fit& fit) {
  const SwitchingSums complete = sum_transitions(in.transitions, posterior, fit.prior);
  const FreeParameters free =
      all_parameters(fit.bank, complete, fit.prior, in.options.one_theta, fit.R_estimated, in.least_R());
  return with_standard_errors({in.recording, learning_filter, fit.prior, in.options.one_theta}, free, complete,
                              fit.bank);
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
  const SwitchingPrior prior =
      switching_prior(gather_training_transitions(recording, bank.structure, bank.noise_factor),
                      fit_global(recording, bank.structure), {}, 1.0);
  const LikelihoodTarget target{recording, learning_filter, prior, true};
  FreeParameters free;
  free.transition = bank.mode_count() > 1;
  return maximise_likelihood(target, free, bank, {options.max_iterations, options.tolerance}).bank;
}

/// Errors of a free run after `measured` samples, n x samples.
Eigen::MatrixXd free_run_errors(const Bank& bank, const Eigen::VectorXd& theta, const Trajectory& run, Index measured) {
  const Index origin = std::max(measured - 1, bank.structure.first_transition());
  if (run.transitions() <= origin) return Eigen::MatrixXd(bank.structure.states, 0);
  const Eigen::MatrixXd errors = errors_ahead(bank.structure, theta, run, origin, run.transitions());
  return run.state.rightCols(errors.cols()).array().isNaN().select(0.0, errors);
}

}  // namespace

Refinement refine_bank(const Recording& recording, const WindowFits& fits, const std::vector<Bank>& banks,
                       const RefineOptions& options, const FilterOptions& filter) {
  if (banks.empty()) throw std::invalid_argument("refinement needs at least one bank");
  if (!banks.front().motion_parameters.empty())
    throw std::invalid_argument("a bank of the motion model " + banks.front().model +
                                " cannot be refined; expected linear or varx");
  const Bank frame = frame_of(banks.front(), options);
  const TrainingTransitions transitions = gather_training_transitions(recording, frame.structure, frame.noise_factor);
  const RefineInput in{recording, fits, frame, transitions, options, filter};

  const CrossValidation validation = cross_validate(in, banks);
  Refinement result;
  result.start = banks.front();
  Fit chosen = validation.chosen();
  if (options.state_dependent_transition)
    if (std::optional<Fit> with_logit = choose_logit(in, validation, result.switching)) chosen = std::move(*with_logit);
  result.candidates = validation.table(chosen.row);
  TrainingFit fit = fit_training_runs(in, chosen.start, chosen.iterations);
  if (Eigen::MatrixXd& weights = fit.model.logit.weights; weights.size() > 0)
    weights.rowwise() -= weights.colwise().mean().eval();  // does not change probabilities
  result.objective = fit.objective;
  chosen.prior = in.prior(chosen.start);
  chosen.bank = bank_of(in, fit);
  chosen = fit_with_measurement_noise(in, validation, chosen, result.measurement);
  result.bank = with_errors(in, fit.posterior, chosen);
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
  std::vector<Eigen::VectorXd> before, after;  // mean squared errors of each left-out run, times its samples
  std::vector<double> samples;
  for (std::size_t s = 0; s < splits.size(); ++s)
    for (const Trajectory& run : splits[s].left_out.runs) {
      const Bank& bank = one_motion.of_splits[s];
      before.push_back(free_run_errors(bank, bank.theta(0), run, measured).rowwise().squaredNorm());
      after.push_back(free_run_errors(bank, thetas[s], run, measured).rowwise().squaredNorm());
      samples.push_back(static_cast<double>(run.transitions()));
    }
  const Eigen::Map<const Eigen::VectorXd> counts(samples.data(), std::ssize(samples));
  // In units of the errors before the fit, all signals have equal weight and gains are roughly in nats.
  Eigen::VectorXd unit = Eigen::VectorXd::Zero(before.front().size());
  for (const Eigen::VectorXd& squares : before) unit += squares / counts.sum();
  const auto score = [&](const std::vector<Eigen::VectorXd>& squares) {
    Eigen::VectorXd scores(counts.size());
    for (Index r = 0; r < scores.size(); ++r)
      scores(r) = -0.5 * squares[static_cast<std::size_t>(r)].cwiseQuotient(unit).sum();
    return scores;
  };
  if (!is_worth_it(paired_loss(score(after), score(before), counts), counts)) return false;
  one_motion.bank = with_theta(
      recording, options, fit_over_horizon(recording, one_motion.bank.structure, one_motion.bank.theta(0), horizon),
      one_motion.bank);
  tbb::parallel_for(std::size_t{0}, splits.size(), [&](std::size_t s) {
    one_motion.of_splits[s] = with_theta(splits[s].training, options, thetas[s], one_motion.of_splits[s]);
  });
  return true;
}

}  // namespace modebank
