#include "filter/learn/from_mixture/bank.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/memberships.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/base/not_a_number.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// "wz", "wz[k-1]", ... A delay of 1 means that the newest sample is that of k; age -1 is written as [k+1].
std::vector<std::string> lagged_names(const std::vector<std::string>& names, Index lags, const InputDelays& delay) {
  std::vector<std::string> all;
  for (Index lag = 0; lag < lags; ++lag)
    for (Index j = 0; j < std::ssize(names); ++j) {
      const std::string& name = names[static_cast<std::size_t>(j)];
      const Index age = delay[j] - 1 + lag;
      all.push_back(age == 0 ? name : name + (age > 0 ? "[k-" + std::to_string(age) + "]" : "[k+1]"));
    }
  return all;
}

}  // namespace

std::vector<std::string> state_names(const Recording& recording, const LinearStructure& structure) {
  return lagged_names(names_of(recording.states), structure.state_lags, 1);
}

std::vector<std::string> input_names(const Recording& recording, const LinearStructure& structure) {
  return lagged_names(names_of(recording.inputs), structure.input_lags, structure.input_delay);
}

Bank bank_frame(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R) {
  check_structure(recording, structure);
  const Index n = structure.states;  // measured states
  if (R.rows() != n || R.cols() != n)
    throw std::invalid_argument("R is " + std::to_string(R.rows()) + " x " + std::to_string(R.cols()) + " for " +
                                std::to_string(n) + " states");
  Bank bank;
  bank.structure = structure;
  bank.C = Eigen::MatrixXd::Identity(n, structure.dimension());
  bank.R = R;
  bank.quantum = recording.quantum;
  bank.R = bank.recording_noise();
  bank.state_names = state_names(recording, structure);
  bank.input_names = input_names(recording, structure);
  bank.dt_s = training_part(recording).median_period_s();
  return bank;
}

Eigen::MatrixXd stated_or(const BankOptions& options, const Eigen::MatrixXd& R) {
  if (!options.measurement_variance) return R;
  return *options.measurement_variance * Eigen::MatrixXd::Identity(R.rows(), R.cols());
}

Mode make_mode(const LinearStructure& structure, const Eigen::VectorXd& theta, const Eigen::MatrixXd& Q,
               const Eigen::MatrixXd& parameter_covariance, const Eigen::VectorXd& standard_error, double weight) {
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(structure.dimension(), structure.dimension());
  whole.topLeftCorner(structure.states, structure.states) = Q;
  return {unpack(structure, theta), whole, parameter_covariance, standard_error, weight};
}

void clear_unidentifiable(Bank& bank, const Eigen::MatrixXd& global_covariance) {
  const Eigen::VectorXd variance = global_covariance.diagonal();
  if (variance.array().isNaN().all()) return;
  for (Mode& mode : bank.modes)
    for (Eigen::Index j = 0; j < variance.size() && mode.standard_error.size() == variance.size(); ++j)
      if (std::isnan(variance(j))) mode.standard_error(j) = not_a_number;
}

void set_mode_sequence(Bank& bank, const TransitionMatrix& transition) {
  bank.transition = transition;
  const Index K = transition.modes();
  bank.initial_probability = Eigen::VectorXd::Constant(K, 1.0 / static_cast<double>(K));
}

Eigen::MatrixXd count_label_transitions(const WindowFits& fits, const Eigen::VectorXi& labels,
                                        const std::vector<Index>& kept) {
  const auto mode_of = [&](Index window) -> Index {
    const auto at = std::find(kept.begin(), kept.end(), labels(window));
    return at == kept.end() ? -1 : at - kept.begin();
  };
  Eigen::MatrixXd counts = Eigen::MatrixXd::Zero(std::ssize(kept), std::ssize(kept));
  Index from = -1;
  for (Index i = 0; i < fits.count(); ++i) {
    const bool follows = i > 0 && fits.windows[i - 1].run == fits.windows[i].run &&
                         fits.windows[i].start - fits.windows[i - 1].start == fits.step;
    if (!follows) from = -1;
    const Index to = mode_of(i);
    if (from >= 0) counts(from, to >= 0 ? to : from) += 1.0;
    if (to >= 0) from = to;
  }
  return counts;
}

TransitionMatrix transition_from_counts(const Eigen::MatrixXd& counts, Index step) {
  Eigen::MatrixXd T = counts.array() + label_count_smoothing;
  for (Index i = 0; i < T.rows(); ++i) {
    T.row(i) /= T.row(i).sum();
    const double leave = 1.0 - T(i, i);
    if (step == 1 || T.rows() == 1) continue;
    const double stay = std::pow(T(i, i), 1.0 / static_cast<double>(step));
    T.row(i) *= (1.0 - stay) / leave;
    T(i, i) = stay;
  }
  return TransitionMatrix(T);
}

namespace {

void check(const BankOptions& options, const WindowFits& fits, const MixtureResult& mixture) {
  const bool of_parameters = mixture.features.size() == 0;
  if (mixture.mixture.components() < 1 || (of_parameters && mixture.mixture.features() < fits.parameter_count()))
    throw std::invalid_argument("the first features of the mixture are not the model's parameters");
  if (!of_parameters && options.theta == ThetaSource::mean)
    throw ConfigurationError(
        "theta = mean needs components whose features are the model's parameters; here the features differ. Set "
        "mixture.features = parameters+noise, or theta = pooled");
  if (options.process_variance && !(*options.process_variance >= 0.0))
    throw std::invalid_argument("process variance " + std::to_string(*options.process_variance) + " is negative");
  if (options.measurement_variance && !(*options.measurement_variance >= 0.0))
    throw std::invalid_argument("measurement variance " + std::to_string(*options.measurement_variance) +
                                " is negative");
}

/// One estimate per component, from the transitions of its windows. With ThetaSource::mean (method of [S25]), theta is
/// the component's mean, and Q is computed from the residuals about this theta.
std::vector<ModeEstimate> estimate_components(const Recording& recording, const WindowFits& fits,
                                              const MixtureResult& mixture, ThetaSource source,
                                              const MotionModel* motion) {
  const TrainingTransitions transitions = gather_training_transitions(recording, fits.structure);
  const Eigen::MatrixXd memberships = transition_memberships(transitions, fits, mixture);
  const ParameterPrior prior{fits.global.theta, fits.prior_sd};
  const ParameterPrior* prior_or_null = fits.prior_sd.size() > 0 ? &prior : nullptr;
  std::vector<ModeEstimate> modes(static_cast<std::size_t>(memberships.cols()));
  tbb::parallel_for(Index{0}, memberships.cols(), [&](Index k) {
    const Eigen::VectorXd weights = memberships.col(k);
    Eigen::VectorXd mean;
    if (source == ThetaSource::mean) mean = mixture.mixture.means.col(k).head(fits.parameter_count());
    const Eigen::VectorXd* given = mean.size() > 0 ? &mean : nullptr;
    modes[static_cast<std::size_t>(k)] =
        motion ? fit_motion_mode(recording, *motion, weights, fits.global, prior_or_null, given)
               : fit_weighted_mode(transitions, weights, fits.global, prior_or_null, given);
  });
  return modes;
}

/// Positions of the components that become modes, possibly none. The other components are added to `screened`.
std::vector<Index> screen(const LinearStructure& structure, const std::vector<ModeEstimate>& modes,
                          const Eigen::VectorXd& weights, std::vector<ScreenedMode>& screened) {
  std::vector<Index> kept;
  for (Index k = 0; k < std::ssize(modes); ++k) {
    const ModeEstimate& mode = modes[static_cast<std::size_t>(k)];
    const std::string reason = screening_reason(structure, mode);
    if (reason.empty())
      kept.push_back(k);
    else
      screened.push_back({k, weights(k), spectral_radius(unpack(structure, mode.theta)), reason});
  }
  return kept;
}

/// Covariance of the windows' parameters in component k, p x p. It is the component's own block. If the component has
/// other features, the covariance is computed from the windows, weighted by their responsibilities.
Eigen::MatrixXd parameter_covariance_of(const WindowFits& fits, const MixtureResult& mixture, Index k) {
  const Index p = fits.parameter_count();
  if (mixture.features.size() == 0) return mixture.mixture.covariances[static_cast<std::size_t>(k)].topLeftCorner(p, p);
  const Eigen::VectorXd responsibility = mixture.responsibilities.all().row(k).transpose();
  std::vector<Index> used;
  for (Index i = 0; i < responsibility.size(); ++i)
    if (responsibility(i) > 0.0 && fits.parameters.col(i).allFinite()) used.push_back(i);
  const Eigen::VectorXd weights =
      responsibility(used) / std::max(responsibility(used).sum(), std::numeric_limits<double>::min());
  const Eigen::MatrixXd parameters = fits.parameters(Eigen::all, used);
  const Eigen::MatrixXd offsets = parameters.colwise() - parameters * weights;
  return offsets * weights.asDiagonal() * offsets.transpose();
}

/// The mode for the bank. For a motion model, the windows' parameter covariance is converted to the linear parameters.
Mode bank_mode(const LinearStructure& structure, const ModeEstimate& estimate,
               const Eigen::MatrixXd& parameter_covariance, double weight) {
  const bool linear = estimate.motion_theta.size() == 0;
  Mode mode = make_mode(
      structure, estimate.theta, estimate.Q,
      linear ? parameter_covariance : estimate.by_motion * parameter_covariance * estimate.by_motion.transpose(),
      estimate.standard_error, weight);
  mode.motion_theta = estimate.motion_theta;
  mode.motion_standard_error = estimate.motion_standard_error;
  return mode;
}

}  // namespace

Bank learn_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                const BankOptions& options, const Eigen::MatrixXd& R, const MotionModel* motion) {
  check(options, fits, mixture);
  std::vector<ModeEstimate> estimates = estimate_components(recording, fits, mixture, options.theta, motion);
  Bank bank = bank_frame(recording, fits.structure, stated_or(options, R));
  bank.model = fits.model;
  if (motion) bank.motion_parameters = motion->parameters();
  const Eigen::VectorXd& weights = mixture.mixture.weights;
  std::vector<Index> kept(estimates.size());
  std::iota(kept.begin(), kept.end(), Index{0});
  if (options.screen) kept = screen(fits.structure, estimates, weights, bank.screened);
  if (kept.empty()) {
    // One mode from all components. It may be unstable, like the global model that it competes with. Its predictions
    // one step ahead may still be right. The summary warns about the instability.
    BankOptions unscreened = options;
    unscreened.screen = false;
    Bank one = learn_bank(recording, fits, merge_components(mixture, 1), unscreened, R, motion);
    one.screened = bank.screened;
    return one;
  }
  const double kept_weight = weights(kept).sum();
  for (const Index k : kept) {
    ModeEstimate& mode = estimates[static_cast<std::size_t>(k)];
    // The mode's own noise has given its standard errors.
    if (options.process_variance) mode.Q = *options.process_variance * Eigen::MatrixXd::Identity(R.rows(), R.cols());
    bank.modes.push_back(
        bank_mode(fits.structure, mode, parameter_covariance_of(fits, mixture, k), weights(k) / kept_weight));
  }
  set_mode_sequence(bank, options.transition == TransitionSource::stay
                              ? TransitionMatrix::sticky(std::ssize(kept), options.stay)
                              : transition_from_counts(count_label_transitions(fits, mixture.labels, kept), fits.step));
  return bank;
}

namespace {

/// Score of the chosen fit with measurement noise; NaN if no run was left out.
double left_out_score(const Refinement& refined) {
  if (!std::isnan(refined.measurement.score)) return refined.measurement.score;
  double score = std::numeric_limits<double>::quiet_NaN();
  for (const RefineCandidate& candidate : refined.candidates)
    if (candidate.selected) score = std::fmax(score, candidate.score);
  return score;
}

}  // namespace

Refinement learn_refined_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                              const BankOptions& options, const Eigen::MatrixXd& R, const FilterOptions& filter) {
  BankOptions of_start = options;
  std::vector<Bank> starts{learn_bank(recording, fits, mixture, options, R)};
  const auto fewer = [&](Index modes) {
    return static_cast<Index>(refine_tuning.modes_kept * static_cast<double>(modes));
  };
  for (Index modes = fewer(starts.front().mode_count()); modes >= 1; modes = fewer(modes)) {
    of_start.screen = options.screen && modes > 1;  // a single mode is always a start; refinement decides later whether
                                                    // it is usable
    starts.push_back(learn_bank(recording, fits, merge_components(mixture, modes), of_start, R));
  }
  RefineOptions em = options.em;
  em.screen = options.screen;
  em.state_dependent_transition = options.transition == TransitionSource::logit;
  em.measurement_noise = em.measurement_noise && !options.measurement_variance;
  const std::optional<Recording> part = learning_part(recording, em.transitions, em.seed);
  const Recording& learned = part ? *part : recording;
  Refinement refined = refine_bank(learned, fits, starts, em, filter);
  if (em.noise_by_input) {  // modes may describe more of the noise than the factor describes
    const double without = left_out_score(refined);
    for (Bank& start : starts) start.noise_factor = fit_noise_factor(learned, fits.structure);
    Refinement with_factor = refine_bank(learned, fits, starts, em, filter);
    if (left_out_score(with_factor) >= without) refined = std::move(with_factor);
  }
  if (part) refined.learned_transitions = part->transitions(Role::train);
  return refined;
}

Refine refinement_asked(const BankOptions& options, bool linear) {
  if (options.refine != Refine::automatic) return options.refine;
  const bool kept =
      options.theta != ThetaSource::pooled || options.process_variance || options.transition == TransitionSource::stay;
  return linear && !kept ? Refine::em : Refine::none;
}

Refinement learn_as_asked(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                          const BankOptions& options, const Eigen::MatrixXd& R,
                          const std::optional<FilterOptions>& filter, const MotionModel* motion) {
  const bool refined = refinement_asked(options, motion == nullptr) == Refine::em;
  if (refined && motion)
    throw std::invalid_argument("refine = em needs linear modes; expected refine = none or auto for the motion model " +
                                fits.model);
  Refinement learned = refined ? learn_refined_bank(recording, fits, mixture, options, R, filter.value())
                               : Refinement{learn_bank(recording, fits, mixture, options, R, motion), {}, {}, {}, {}};
  if (motion) return learned;
  clear_unidentifiable(learned.bank, fits.global.covariance);
  clear_unidentifiable(learned.start, fits.global.covariance);
  return learned;
}

}  // namespace modebank
