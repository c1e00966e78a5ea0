#include "filter/learn/from_mixture/bank.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/switching/regression.hpp"
#include "ident/base/not_a_number.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// A delay of 1 means that the newest sample is that of k; age -1 is written as [k+1].
std::vector<std::string> lagged_names(const std::vector<std::string>& names, Index lags, const InputDelays& delay) {
  std::vector<std::string> all;
  for (Index lag = 0; lag < lags; ++lag)
    for (Index j = 0; j < std::ssize(names); ++j) {
      const std::string& name = names[j];
      const Index age = delay[j] - 1 + lag;
      all.push_back(age == 0 ? name : name + (age > 0 ? "[k-" + std::to_string(age) + "]" : "[k+1]"));
    }
  return all;
}

void check(const BankOptions& options, const WindowFits& fits, const MixtureResult& mixture) {
  const bool of_parameters = mixture.features.size() == 0;
  if (mixture.mixture.components() < 1 || (of_parameters && mixture.mixture.features() < fits.parameter_count()))
    throw std::invalid_argument("the first features of the mixture are not the model's parameters");
  if (mixture.responsibilities.windows() != fits.count() || mixture.labels.size() != fits.count())
    throw std::invalid_argument("the mixture is not one of these " + std::to_string(fits.count()) + " windows");
  if (!of_parameters && options.theta == ThetaSource::mean)
    throw ConfigurationError(
        "theta = mean needs components whose features are the model's parameters; here the features differ. Set "
        "mixture.features = parameters+noise, or theta = pooled");
  for (const std::optional<double>& variance : {options.process_variance, options.measurement_variance})
    if (variance && !(*variance >= 0.0))
      throw std::invalid_argument("a stated variance of " + std::to_string(*variance) + " is negative");
}

/// One estimate per component, from the transitions of its windows. With ThetaSource::mean (method of [S25]), theta is
/// the component's mean, and Q is computed from the residuals about this theta.
std::vector<ModeEstimate> estimate_components(const Recording& recording, const WindowFits& fits,
                                              const MixtureResult& mixture, ThetaSource source,
                                              const MotionModel* motion) {
  const TrainingTransitions transitions = gather_training_transitions(recording, fits.structure);
  const Eigen::MatrixXd memberships = transition_memberships(transitions, fits, mixture);
  const ParameterPrior stated{fits.global.theta, fits.prior_sd};
  const ParameterPrior* prior = fits.prior_sd.size() > 0 ? &stated : nullptr;
  std::vector<ModeEstimate> modes(memberships.cols());
  tbb::parallel_for(Index{0}, memberships.cols(), [&](Index k) {
    Eigen::VectorXd mean;
    if (source == ThetaSource::mean) mean = mixture.mixture.means.col(k).head(fits.parameter_count());
    const Eigen::VectorXd* given = mean.size() > 0 ? &mean : nullptr;
    modes[k] = motion ? fit_motion_mode(recording, *motion, memberships.col(k), fits.global, prior, given)
                      : fit_weighted_mode(transitions, memberships.col(k), fits.global, prior, given);
  });
  return modes;
}

/// Positions of the components that become modes. The others are added to `screened`: those with fewer effective
/// transitions than regressors + 1, and those with a spectral radius of I + A above 1.
std::vector<Index> usable(const LinearStructure& structure, const std::vector<ModeEstimate>& modes,
                          const Eigen::VectorXd& weights, bool screens, std::vector<ScreenedMode>& screened) {
  std::vector<Index> kept;
  for (Index k = 0; k < std::ssize(modes); ++k) {
    const double radius = spectral_radius(unpack(structure, modes[k].theta));
    const bool starved = modes[k].effective_transitions < static_cast<double>(structure.regressors() + 1);
    const bool unstable = !(radius <= 1.0 + spectral_radius_slack) && !(weights(k) >= least_unstable_share);
    if (screens && (starved || unstable))
      screened.push_back({k, weights(k), radius, starved ? "starved" : "unstable"});
    else
      kept.push_back(k);
  }
  return kept;
}

/// Covariance of the windows' parameters in component k, p x p: the component's own block, or, if it has other
/// features, that of the windows, weighted by their responsibilities.
Eigen::MatrixXd parameter_covariance_of(const WindowFits& fits, const MixtureResult& mixture, Index k) {
  const Index p = fits.parameter_count();
  if (mixture.features.size() == 0) return mixture.mixture.covariances[k].topLeftCorner(p, p);
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

}  // namespace

std::vector<std::string> state_names(const Recording& recording, const LinearStructure& structure) {
  return lagged_names(names_of(recording.states), structure.state_lags, 1);
}

std::vector<std::string> input_names(const Recording& recording, const LinearStructure& structure) {
  return lagged_names(names_of(recording.inputs), structure.input_lags, structure.input_delay);
}

Bank bank_frame(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R) {
  check_structure(recording, structure);
  const Index n = structure.states;
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
  const Eigen::ArrayXd variance = global_covariance.diagonal();
  if (variance.isNaN().all()) return;
  for (Mode& mode : bank.modes)
    if (mode.standard_error.size() == variance.size())
      mode.standard_error = variance.isNaN().select(not_a_number, mode.standard_error);
}

void set_mode_sequence(Bank& bank, const TransitionMatrix& transition) {
  bank.transition = transition;
  const Index K = transition.modes();
  bank.initial_probability = Eigen::VectorXd::Constant(K, 1.0 / static_cast<double>(K));
}

Eigen::MatrixXd count_label_transitions(const WindowFits& fits, const Eigen::VectorXi& labels,
                                        const std::vector<Index>& kept) {
  Eigen::MatrixXd counts = Eigen::MatrixXd::Zero(std::ssize(kept), std::ssize(kept));
  Index from = -1;
  for (Index i = 0; i < fits.count(); ++i) {
    if (i == 0 || fits.windows[i - 1].run != fits.windows[i].run ||
        fits.windows[i].start - fits.windows[i - 1].start != fits.step)
      from = -1;
    const auto at = std::find(kept.begin(), kept.end(), labels(i));
    const Index to = at == kept.end() ? from : at - kept.begin();
    if (from >= 0) counts(from, to) += 1.0;
    from = to;
  }
  return counts;
}

TransitionMatrix transition_from_counts(const Eigen::MatrixXd& counts, Index step) {
  Eigen::MatrixXd T = counts.array() + label_count_smoothing;
  for (Index i = 0; i < T.rows(); ++i) {
    T.row(i) /= T.row(i).sum();
    if (step == 1 || T.rows() == 1) continue;
    const double stay = std::pow(T(i, i), 1.0 / static_cast<double>(step));
    T.row(i) *= (1.0 - stay) / (1.0 - T(i, i));
    T(i, i) = stay;
  }
  return TransitionMatrix(T);
}

Bank learn_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                const BankOptions& options, const Eigen::MatrixXd& R, const MotionModel* motion) {
  check(options, fits, mixture);
  const std::vector<ModeEstimate> estimates = estimate_components(recording, fits, mixture, options.theta, motion);
  Bank bank = bank_frame(recording, fits.structure, stated_or(options, R));
  bank.model = fits.model;
  if (motion) bank.motion_parameters = motion->parameters();
  const std::vector<Index> kept =
      usable(fits.structure, estimates, mixture.mixture.weights, options.screen, bank.screened);
  if (kept.empty()) {
    // One mode from all components may be unstable, like the global model that it competes with; its predictions one
    // step ahead may still be right.
    BankOptions unscreened = options;
    unscreened.screen = false;
    Bank one = learn_bank(recording, fits, merge_components(mixture, 1), unscreened, R, motion);
    one.screened = bank.screened;
    return one;
  }
  for (const Index k : kept) {
    const ModeEstimate& of = estimates[k];
    Eigen::MatrixXd Q = of.Q, covariance = parameter_covariance_of(fits, mixture, k);
    // A stated Q: the mode's own noise has given its standard errors.
    if (options.process_variance) Q = *options.process_variance * Eigen::MatrixXd::Identity(R.rows(), R.cols());
    if (motion) covariance = of.by_motion * covariance * of.by_motion.transpose();
    bank.modes.push_back(make_mode(fits.structure, of.theta, Q, covariance, of.standard_error,
                                   mixture.mixture.weights(k) / mixture.mixture.weights(kept).sum()));
    bank.modes.back().motion_theta = of.motion_theta;
    bank.modes.back().motion_standard_error = of.motion_standard_error;
  }
  set_mode_sequence(bank, options.transition == TransitionSource::stay
                              ? TransitionMatrix::sticky(std::ssize(kept), options.stay)
                              : transition_from_counts(count_label_transitions(fits, mixture.labels, kept), fits.step));
  return bank;
}

Refinement learn_refined_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                              const BankOptions& options, const Eigen::MatrixXd& R, const FilterOptions& filter) {
  BankOptions of_start = options;
  std::vector<Bank> starts{learn_bank(recording, fits, mixture, options, R)};
  const auto fewer = [&](Index modes) { return static_cast<Index>(modes_kept * static_cast<double>(modes)); };
  for (Index modes = fewer(starts.front().mode_count()); modes >= 1; modes = fewer(modes)) {
    of_start.screen = options.screen && modes > 1;  // a single mode is always a start
    starts.push_back(learn_bank(recording, fits, merge_components(mixture, modes), of_start, R));
  }
  RefineOptions em = options.em;
  em.screen = options.screen;
  em.state_dependent_transition = options.transition == TransitionSource::logit;
  em.measurement_noise = em.measurement_noise && !options.measurement_variance;
  const std::optional<Recording> part = learning_part(recording, em.transitions, em.seed);
  Refinement refined = refine_bank(part ? *part : recording, fits, starts, em, filter);
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
                               : Refinement{learn_bank(recording, fits, mixture, options, R, motion)};
  if (motion) return learned;
  clear_unidentifiable(learned.bank, fits.global.covariance);
  clear_unidentifiable(learned.start, fits.global.covariance);
  return learned;
}

}  // namespace modebank
