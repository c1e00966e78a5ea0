#include "filter/refine.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "filter/bank_frame.hpp"
#include "filter/refine_noise.hpp"
#include "filter/refine_screening.hpp"
#include "filter/refine_start.hpp"
#include "filter/validation_split.hpp"
#include "ident/fit_window.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {
namespace {

// Iterations after which the runs left out are scored. Not before 10: the start has seen all training runs, and it
// takes the fit to the others a while to forget that. The last one counts as the limit where that is lower.
constexpr std::array<Index, 7> checkpoints{10, 20, 35, 60, 100, 200, 1000};
constexpr std::array<double, 4> forgettings{0.95, 0.98, 0.995, 1.0};
constexpr std::array<double, 3> prior_samples{2.0, 5.0, 20.0};
// Transitions that the prior on Q is worth: at first, and where nothing is left out to choose by.
constexpr double least_measurement_share = 1e-9;  // of the global residual variance: R that is as good as none
constexpr double prior_strength = 4.0, unit_strength = 1.0;
constexpr std::array<double, 2> other_strengths{1.0, 16.0};

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

double first_strength(const RefineOptions& options) { return options.folds > 1 ? prior_strength : unit_strength; }

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

std::vector<Index> checkpoints_up_to(Index limit) {
  std::vector<Index> list;
  for (const Index checkpoint : checkpoints)
    if (checkpoint < limit) list.push_back(checkpoint);
  list.push_back(limit);
  return list;
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
  for (const Index checkpoint : checkpoints_up_to(options.max_iterations)) {
    for (; done < checkpoint; ++done) climb.step();
    banks.push_back(with_modes(frame, climb.model()));
  }
  return banks;
}

/// Scores of training runs left out, for every start, number of iterations and way to adapt.
class CrossValidation {
 public:
  CrossValidation(const Recording& recording, const WindowFits& fits, const Bank& frame, const RefineOptions& options,
                  const FilterOptions& filter)
      : splits_(validation_splits(recording, options.folds)),
        fits_(fits),
        frame_(frame),
        options_(options),
        filter_(filter) {
    for (const ValidationSplit& split : splits_) samples_ += split.left_out.transitions(Role::train);
  }

  /// Tries all and remembers the best of these and earlier ones; adds a row for each to the table. Without anything to
  /// leave out the first one is the best, run to convergence.
  void consider(const std::vector<Start>& candidates) {
    std::vector<std::vector<Bank>> banks(candidates.size() * splits_.size());
    tbb::parallel_for(std::size_t{0}, banks.size(), [&](std::size_t i) {
      banks[i] =
          climb_split(frame_, candidates[i / splits_.size()], fits_, splits_[i % splits_.size()].training, options_);
    });
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const auto first = banks.begin() + static_cast<std::ptrdiff_t>(i * splits_.size());
      add(candidates[i], {first, first + static_cast<std::ptrdiff_t>(splits_.size())});
    }
  }

  const Start& best() const { return best_; }
  Index iterations() const { return table_[selected_].iterations; }

  std::vector<RefineCandidate> table() const {
    std::vector<RefineCandidate> rows = table_;
    rows[selected_].selected = true;
    return rows;
  }

  /// How the noise scale should move in the best one's filter.
  NoiseAdaptation adaptation() const {
    if (splits_.empty() || filter_.noise != FilterNoise::adaptive) return {};
    std::vector<NoiseAdaptation> ways;
    for (const double forgetting : forgettings)
      for (const double prior : prior_samples) ways.push_back({forgetting, prior});
    std::vector<double> scores(ways.size());
    tbb::parallel_for(std::size_t{0}, ways.size(), [&](std::size_t w) {
      std::vector<Bank> banks = best_banks_;
      for (Bank& bank : banks) bank.noise_adaptation = ways[w];
      scores[w] = score(banks);
    });
    return ways[std::max_element(scores.begin(), scores.end()) - scores.begin()];
  }

 private:
  /// Mean over the samples left out; `banks`: one per split.
  double score(const std::vector<Bank>& banks) const {
    double sum = 0.0;
    for (std::size_t s = 0; s < splits_.size(); ++s)
      for (const Trajectory& run : splits_[s].left_out.runs) sum += log_likelihood(banks[s], run, filter_);
    return std::isnan(sum) ? -std::numeric_limits<double>::infinity() : sum / static_cast<double>(samples_);
  }

  static std::vector<Bank> at_checkpoint(const std::vector<std::vector<Bank>>& by_split, std::size_t checkpoint) {
    std::vector<Bank> banks;
    for (const std::vector<Bank>& of_split : by_split) banks.push_back(of_split[checkpoint]);
    return banks;
  }

  void add(const Start& candidate, const std::vector<std::vector<Bank>>& by_split) {
    RefineCandidate row{candidate.name,          candidate.model.modes(),
                        candidate.shared,        candidate.noise_transitions,
                        options_.max_iterations, not_a_number};
    std::size_t checkpoint = 0;
    if (!splits_.empty()) {
      std::vector<double> scores(by_split.front().size());
      tbb::parallel_for(std::size_t{0}, scores.size(),
                        [&](std::size_t c) { scores[c] = score(at_checkpoint(by_split, c)); });
      checkpoint = std::max_element(scores.begin(), scores.end()) - scores.begin();
      row.iterations = checkpoints_up_to(options_.max_iterations)[checkpoint];
      row.score = scores[checkpoint];
    }
    table_.push_back(row);
    if (table_.size() > 1 && !(row.score > table_[selected_].score)) return;
    selected_ = table_.size() - 1;
    best_ = candidate;
    if (!splits_.empty()) best_banks_ = at_checkpoint(by_split, checkpoint);
  }

  std::vector<ValidationSplit> splits_;
  const WindowFits& fits_;
  const Bank& frame_;
  RefineOptions options_;
  FilterOptions filter_;
  Index samples_ = 0;
  std::vector<RefineCandidate> table_;
  std::size_t selected_ = 0;
  Start best_;
  std::vector<Bank> best_banks_;
};

/// Which start, what its modes share and how many iterations first; then how strong the prior on Q is.
CrossValidation cross_validate(const Recording& recording, const WindowFits& fits, const std::vector<Start>& candidates,
                               const Bank& frame, const RefineOptions& options, const FilterOptions& filter) {
  CrossValidation validation(recording, fits, frame, options, filter);
  validation.consider(candidates);
  if (std::isnan(validation.table().front().score)) return validation;  // nothing was left out
  std::vector<Start> by_strength;
  for (const double strength : other_strengths) {
    by_strength.push_back(validation.best());
    by_strength.back().noise_transitions = strength;
  }
  validation.consider(by_strength);
  return validation;
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
      starts.push_back({name, model, shared, first_strength(options)});
  return starts;
}

}  // namespace

Refinement refine_bank(const Recording& recording, const WindowFits& fits, const std::vector<Bank>& banks,
                       const RefineOptions& options, const FilterOptions& filter) {
  if (banks.empty()) throw std::invalid_argument("no bank to refine");
  Bank frame = banks.front();
  // The fit takes the state as measured exactly: a start's R would count what Q then holds twice.
  if (options.measurement_noise)
    frame.R = least_measurement_share * fits.global.noise_variance().asDiagonal().toDenseMatrix();
  if (!frame.motion_parameters.empty())
    throw std::invalid_argument("a bank of the motion model " + frame.model + " cannot be refined, a linear one can");
  const TrainingTransitions transitions = gather_training_transitions(recording, frame.structure);
  SwitchingPrior prior = switching_prior(transitions, fits.global, fits.prior_sd, first_strength(options));
  const CrossValidation validation =
      cross_validate(recording, fits, all_starts(fits, banks, transitions, prior, options), frame, options, filter);

  Refinement result;
  result.start = banks.front();
  result.candidates = validation.table();
  const Start& start = validation.best();
  prior.noise_transitions = start.noise_transitions;
  Climb climb(transitions, prior, start.shared, options.tolerance, start.model);
  for (Index i = 0; i < validation.iterations() && !climb.converged(); ++i) climb.step();
  result.objective = climb.objective();

  SwitchingRegression model = climb.model();
  ModePosterior posterior = climb.posterior();
  std::vector<ScreenedMode> screened = frame.screened;
  while (options.screen && screen_worst_mode(frame.structure, transitions, posterior, start.shared, model, screened)) {
    Climb rest(transitions, prior, start.shared, options.tolerance, model);
    for (Index i = 0; i < iterations_after_screening; ++i) rest.step();
    model = rest.model();
    posterior = rest.posterior();
  }
  result.bank = with_modes(frame, model);
  result.bank.screened = std::move(screened);
  result.bank.noise_adaptation = validation.adaptation();
  set_standard_errors(transitions, prior, model, posterior, result.bank);
  if (options.measurement_noise) estimate_measurement_noise(recording, filter, result.bank);
  return result;
}

}  // namespace modebank
