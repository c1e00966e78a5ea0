#include "filter/refine.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "filter/bank_frame.hpp"
#include "filter/refine_screening.hpp"
#include "filter/refine_start.hpp"
#include "filter/validation_split.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {
namespace {

constexpr std::array<Index, 12> checkpoints{1, 2, 4, 7, 12, 20, 35, 60, 100, 200, 500, 1000};
constexpr std::array<double, 4> forgettings{0.95, 0.98, 0.995, 1.0};
constexpr std::array<double, 3> prior_samples{2.0, 5.0, 20.0};
constexpr std::array<double, 3> prior_strengths{1.0, 4.0, 16.0};  // transitions of the prior on Q

/// The modes of a bank put in place of another's, everything else as there.
Bank with_modes(const Bank& frame, const SwitchingRegression& model) {
  Bank bank = frame;
  bank.modes.clear();
  const Index p = bank.structure.parameters(), K = model.modes();
  for (Index j = 0; j < K; ++j)
    bank.modes.push_back(make_mode(bank.structure, model.theta.col(j), model.Q[static_cast<std::size_t>(j)],
                                   Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Constant(p, not_a_number),
                                   1.0 / static_cast<double>(K)));
  bank.transition = TransitionMatrix(model.transition);
  bank.initial_probability = model.initial;
  return bank;
}

/// Expectation-maximisation on one set of runs.
class Climb {
 public:
  Climb(const TrainingTransitions& transitions, const SwitchingPrior& prior, SharedParts shared, double tolerance,
        SwitchingRegression start)
      : transitions_(transitions), prior_(prior), shared_(shared), tolerance_(tolerance), model_(std::move(start)) {
    posterior_ = smooth_modes(transitions_, model_);
  }

  /// One iteration; does nothing once the objective stands still.
  void step() {
    if (converged_) return;
    objective_.push_back(posterior_.log_likelihood + log_prior(prior_, shared_, model_));
    maximise(transitions_, posterior_, prior_, shared_, model_);
    posterior_ = smooth_modes(transitions_, model_);
    const double gain = posterior_.log_likelihood + log_prior(prior_, shared_, model_) - objective_.back();
    // The first step leaves the start's own optimum for the prior's and may lose.
    converged_ = objective_.size() > 1 && gain < tolerance_ * static_cast<double>(transitions_.count());
  }

  bool converged() const { return converged_; }
  const SwitchingRegression& model() const { return model_; }
  const ModePosterior& posterior() const { return posterior_; }
  const std::vector<double>& objective() const { return objective_; }

 private:
  const TrainingTransitions& transitions_;
  const SwitchingPrior& prior_;
  SharedParts shared_;
  double tolerance_;
  SwitchingRegression model_;
  ModePosterior posterior_;
  std::vector<double> objective_;
  bool converged_ = false;
};

/// What is refined from where.
struct Start {
  std::string name;
  SwitchingRegression model;
  SharedParts shared = SharedParts::none;
  double noise_transitions = 0.0;
};

std::vector<SharedParts> ways_to_share(Sharing share) {
  switch (share) {
    case Sharing::none:
      return {SharedParts::none};
    case Sharing::theta:
      return {SharedParts::theta};
    case Sharing::noise:
      return {SharedParts::noise};
    case Sharing::best:
      break;
  }
  return {SharedParts::none, SharedParts::theta, SharedParts::noise};
}

double score(const Bank& bank, const Recording& left_out, const FilterOptions& filter) {
  double sum = 0.0;
  for (const Trajectory& run : left_out.runs) sum += log_likelihood(bank, run, filter);
  return std::isnan(sum) ? -std::numeric_limits<double>::infinity() : sum;
}

/// The banks of one start on one split, at each checkpoint up to the limit.
std::vector<Bank> climb_split(const Bank& frame, const Start& start, const WindowFits& fits, const Recording& training,
                              const RefineOptions& options) {
  const TrainingTransitions transitions = gather_training_transitions(training, frame.structure);
  const SwitchingPrior prior =
      switching_prior(transitions, fit_global(training, frame.structure), fits.prior_sd, start.noise_transitions);
  Climb climb(transitions, prior, start.shared, options.tolerance, start.model);
  std::vector<Bank> banks;
  Index done = 0;
  for (const Index checkpoint : checkpoints) {
    if (checkpoint > options.max_iterations) break;
    for (; done < checkpoint; ++done) climb.step();
    banks.push_back(with_modes(frame, climb.model()));
  }
  return banks;
}

struct Choice {
  std::size_t start = 0;
  Index iterations = 0;
  NoiseAdaptation adaptation;
};

/// Scores of training runs left out, for every start, number of iterations and way to adapt.
class CrossValidation {
 public:
  CrossValidation(const Recording& recording, const WindowFits& fits, const Bank& frame,
                  const std::vector<Start>& starts, const RefineOptions& options, const FilterOptions& filter)
      : splits_(validation_splits(recording, options.folds)), filter_(filter) {
    for (const ValidationSplit& split : splits_) samples_ += split.left_out.transitions(Role::train);
    banks_.assign(starts.size() * splits_.size(), {});
    tbb::parallel_for(std::size_t{0}, banks_.size(), [&](std::size_t i) {
      banks_[i] = climb_split(frame, starts[i / splits_.size()], fits, splits_[i % splits_.size()].training, options);
    });
  }

  bool possible() const { return !splits_.empty(); }

  /// Mean score at each checkpoint of one start.
  std::vector<double> scores(std::size_t start) const {
    std::vector<double> sums(banks_[start * splits_.size()].size());
    tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t c) {
      for (std::size_t s = 0; s < splits_.size(); ++s)
        sums[c] += score(banks_[start * splits_.size() + s][c], splits_[s].left_out, filter_);
      sums[c] /= static_cast<double>(samples_);
    });
    return sums;
  }

  /// The best way to adapt at one checkpoint of one start.
  NoiseAdaptation best_adaptation(std::size_t start, std::size_t checkpoint) const {
    std::vector<NoiseAdaptation> ways;
    for (const double forgetting : forgettings)
      for (const double prior : prior_samples) ways.push_back({forgetting, prior});
    std::vector<double> sums(ways.size());
    tbb::parallel_for(std::size_t{0}, ways.size(), [&](std::size_t w) {
      for (std::size_t s = 0; s < splits_.size(); ++s) {
        Bank bank = banks_[start * splits_.size() + s][checkpoint];
        bank.noise_adaptation = ways[w];
        sums[w] += score(bank, splits_[s].left_out, filter_);
      }
    });
    return ways[std::max_element(sums.begin(), sums.end()) - sums.begin()];
  }

 private:
  std::vector<ValidationSplit> splits_;
  FilterOptions filter_;
  std::vector<std::vector<Bank>> banks_;  // start by start, split by split
  Index samples_ = 0;
};

Choice choose(const CrossValidation& validation, const std::vector<Start>& starts, const RefineOptions& options,
              const FilterOptions& filter, std::vector<RefineCandidate>& table) {
  Choice choice{0, options.max_iterations, {}};
  double best = -std::numeric_limits<double>::infinity();
  std::size_t best_checkpoint = 0, selected = 0;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    table.push_back({starts[i].name, starts[i].model.modes(), starts[i].shared, starts[i].noise_transitions,
                     options.max_iterations, not_a_number});
    if (!validation.possible()) continue;
    const std::vector<double> scores = validation.scores(i);
    const std::size_t checkpoint = std::max_element(scores.begin(), scores.end()) - scores.begin();
    table.back().iterations = checkpoints[checkpoint];
    table.back().score = scores[checkpoint];
    if (!(scores[checkpoint] > best)) continue;
    best = scores[checkpoint];
    best_checkpoint = checkpoint;
    selected = i;
    choice = {i, checkpoints[checkpoint], {}};
  }
  table[selected].selected = true;
  if (validation.possible() && filter.noise == FilterNoise::adaptive)
    choice.adaptation = validation.best_adaptation(choice.start, best_checkpoint);
  return choice;
}

/// Standard errors given the smoothed modes: of theta by its posterior covariance, of Q by the normal scatter's (Q_ii
/// Q_jj + Q_ij^2) / W, of T by the binomial's. What is not known about the modes themselves is not in them.
void set_standard_errors(const TrainingTransitions& transitions, const SwitchingPrior& prior,
                         const SwitchingRegression& model, const ModePosterior& posterior, Bank& bank) {
  const std::vector<Eigen::MatrixXd> covariances = parameter_covariances(transitions, posterior, prior, model);
  const Eigen::VectorXd weights =
      (posterior.probability.transpose() * transitions.usable).cwiseMax(std::numeric_limits<double>::min());
  for (Index j = 0; j < model.modes(); ++j) {
    Mode& mode = bank.modes[static_cast<std::size_t>(j)];
    mode.spread = covariances[static_cast<std::size_t>(j)];
    mode.standard_error = mode.spread.diagonal().cwiseSqrt();
    mode.weight = weights(j) / weights.sum();
    const Eigen::VectorXd variance = mode.Q.diagonal();
    mode.Q_standard_error =
        ((variance * variance.transpose()).array() + mode.Q.array().square()).sqrt() / std::sqrt(weights(j));
  }
  const Eigen::ArrayXXd T = model.transition.array();
  const Eigen::ArrayXd rows = posterior.switches.rowwise().sum().array() + 1.0;
  bank.transition_standard_error = (T * (1.0 - T)).colwise() / rows;
  bank.transition_standard_error = bank.transition_standard_error.cwiseSqrt();
}

constexpr Index iterations_after_screening = 10;

std::vector<Start> all_starts(const WindowFits& fits, const std::vector<Bank>& banks,
                              const TrainingTransitions& transitions, const SwitchingPrior& prior,
                              const RefineOptions& options) {
  std::vector<std::pair<std::string, SwitchingRegression>> models;
  for (const Bank& bank : banks) models.emplace_back("mixture", switching_model(bank));
  for (Index i = 0; i < options.restarts; ++i)
    models.emplace_back(
        fmt::format("stretches {}", i + 1),
        start_from_stretches(transitions, prior, banks.front().mode_count(), fits.length, options.seed, i));
  std::vector<Start> starts;
  for (const auto& [name, model] : models)
    for (const SharedParts shared : ways_to_share(options.share))
      for (const double strength : prior_strengths) {
        starts.push_back({name, model, shared, strength});
        if (options.folds < 2) break;  // nothing could choose among them
      }
  return starts;
}

}  // namespace

Refinement refine_bank(const Recording& recording, const WindowFits& fits, const std::vector<Bank>& banks,
                       const RefineOptions& options, const FilterOptions& filter) {
  if (banks.empty()) throw std::invalid_argument("no bank to refine");
  const Bank& frame = banks.front();
  if (!frame.motion_parameters.empty())
    throw std::invalid_argument("a bank of the motion model " + frame.model + " cannot be refined, a linear one can");
  const TrainingTransitions transitions = gather_training_transitions(recording, frame.structure);
  SwitchingPrior prior = switching_prior(transitions, fits.global, fits.prior_sd, prior_strengths.front());
  const std::vector<Start> starts = all_starts(fits, banks, transitions, prior, options);

  Refinement result;
  result.start = frame;
  const CrossValidation validation(recording, fits, frame, starts, options, filter);
  const Choice choice = choose(validation, starts, options, filter, result.candidates);
  const Start& start = starts[choice.start];
  prior.noise_transitions = start.noise_transitions;
  Climb climb(transitions, prior, start.shared, options.tolerance, start.model);
  for (Index i = 0; i < choice.iterations && !climb.converged(); ++i) climb.step();
  result.objective = climb.objective();

  SwitchingRegression model = climb.model();
  ModePosterior posterior = climb.posterior();
  std::vector<ScreenedMode> screened = frame.screened;
  while (screen_worst_mode(frame.structure, transitions, posterior, start.shared, model, screened)) {
    Climb rest(transitions, prior, start.shared, options.tolerance, model);
    for (Index i = 0; i < iterations_after_screening; ++i) rest.step();
    model = rest.model();
    posterior = rest.posterior();
  }
  result.bank = with_modes(frame, model);
  result.bank.screened = std::move(screened);
  result.bank.noise_adaptation = choice.adaptation;
  set_standard_errors(transitions, prior, model, posterior, result.bank);
  return result;
}

}  // namespace modebank
