#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "filter/learn/competitors/noise_by_input.hpp"
#include "filter/learn/from_mixture/bank_frame.hpp"
#include "filter/learn/from_mixture/memberships.hpp"
#include "filter/learn/from_mixture/motion_modes.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/from_mixture/transition_learning.hpp"
#include "filter/learn/learn.hpp"
#include "filter/learn/refine/learning_part.hpp"
#include "filter/learn/tuning.hpp"
#include "mixture/select.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

void check(const BankOptions& options, const WindowFits& fits, const MixtureResult& mixture) {
  const bool of_parameters = mixture.features.size() == 0;
  if (mixture.mixture.components() < 1 || (of_parameters && mixture.mixture.features() < fits.parameter_count()))
    throw std::invalid_argument("the first features of the mixture are not the model's parameters");
  if (!of_parameters && options.theta == ThetaSource::mean)
    throw ConfigurationError(
        "theta = mean needs components whose features are the model's parameters; here the features differ. Set "
        "mixture.features = parameters+noise, or theta = pooled");
  if (options.noise == NoiseSource::fixed && !(options.process_variance >= 0.0))
    throw std::invalid_argument("process variance " + std::to_string(options.process_variance) + " is negative");
  if (options.measurement_variance && !(*options.measurement_variance >= 0.0))
    throw std::invalid_argument("measurement variance " + std::to_string(*options.measurement_variance) +
                                " is negative");
}

std::optional<ParameterPrior> prior_of(const WindowFits& fits) {
  if (fits.prior_sd.size() == 0) return std::nullopt;
  return ParameterPrior{fits.global.theta, fits.prior_sd};
}

/// A linear estimate for a component, and the estimate of the motion model if there is a motion model.
struct ComponentEstimate {
  ModeEstimate linear;
  std::optional<MotionMode> motion;
};

/// Common inputs of all estimates of the components.
struct EstimationInput {
  const Recording& recording;
  const WindowFits& fits;
  const MixtureResult& mixture;
  ThetaSource source;
};

/// Method of [S25]: theta is the component's mean, and Q is computed from the residuals about this theta.
Eigen::VectorXd component_mean(const EstimationInput& in, Index k) {
  return in.mixture.mixture.means.col(k).head(in.fits.parameter_count());
}

std::vector<ModeEstimate> linear_modes(const EstimationInput& in, const TrainingTransitions& transitions,
                                       const Eigen::MatrixXd& memberships, const ParameterPrior* prior) {
  if (in.source == ThetaSource::pooled) return fit_pooled_modes(transitions, memberships, in.fits.global, prior);
  std::vector<ModeEstimate> modes;
  for (Index k = 0; k < memberships.cols(); ++k)
    modes.push_back(
        assess_weighted_mode(transitions, memberships.col(k), in.fits.global, prior, component_mean(in, k)));
  return modes;
}

std::vector<MotionMode> motion_modes(const EstimationInput& in, const MotionModel& motion,
                                     const Eigen::MatrixXd& memberships, const ParameterPrior* prior) {
  if (in.source == ThetaSource::pooled)
    return fit_motion_modes(in.recording, motion, memberships, in.fits.global, prior);
  std::vector<MotionMode> modes;
  for (Index k = 0; k < memberships.cols(); ++k) {
    const Eigen::VectorXd theta = component_mean(in, k);
    modes.push_back(fit_motion_mode(in.recording, motion, memberships.col(k), in.fits.global, prior, &theta));
  }
  return modes;
}

std::vector<ComponentEstimate> estimate_components(const EstimationInput& in, const MotionModel* motion) {
  const TrainingTransitions transitions = gather_training_transitions(in.recording, in.fits.structure);
  const Eigen::MatrixXd memberships = transition_memberships(transitions, in.fits, in.mixture);
  const std::optional<ParameterPrior> prior = prior_of(in.fits);
  const ParameterPrior* prior_or_null = prior ? &*prior : nullptr;
  std::vector<ComponentEstimate> estimates;
  if (!motion)
    for (ModeEstimate& mode : linear_modes(in, transitions, memberships, prior_or_null))
      estimates.push_back({std::move(mode), std::nullopt});
  else
    for (MotionMode& mode : motion_modes(in, *motion, memberships, prior_or_null))
      estimates.push_back({mode.linear, std::move(mode)});
  return estimates;
}

/// Positions of the components that become modes, possibly none. The other components are added to `screened`.
std::vector<Index> screen(const LinearStructure& structure, const std::vector<ComponentEstimate>& modes,
                          const Eigen::VectorXd& weights, std::vector<ScreenedMode>& screened) {
  std::vector<Index> kept;
  for (Index k = 0; k < std::ssize(modes); ++k) {
    const std::string reason = screening_reason(structure, modes[k].linear);
    if (reason.empty())
      kept.push_back(k);
    else
      screened.push_back({k, weights(k), spectral_radius(unpack(structure, modes[k].linear.theta)), reason});
  }
  return kept;
}

/// Sets Q of the bank's modes from the chosen source. The noise of a mode itself is always used for theta and its
/// standard errors.
void set_process_noise(std::vector<ComponentEstimate>& modes, const BankOptions& options) {
  const Index n = modes.front().linear.Q.rows();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  double weight = 0.0;
  for (const ComponentEstimate& mode : modes) {
    sum += mode.linear.effective_transitions * mode.linear.Q;
    weight += mode.linear.effective_transitions;
  }
  for (ComponentEstimate& mode : modes) {
    if (options.noise == NoiseSource::shared) mode.linear.Q = sum / weight;
    if (options.noise == NoiseSource::fixed) mode.linear.Q = options.process_variance * Eigen::MatrixXd::Identity(n, n);
  }
}

/// Covariance of the windows' parameters in component k, p x p. It is the component's own block. If the component has
/// other features, the covariance is computed from the windows, weighted by their responsibilities.
Eigen::MatrixXd parameter_covariance_of(const WindowFits& fits, const MixtureResult& mixture, Index k) {
  const Index p = fits.parameter_count();
  if (mixture.features.size() == 0) return mixture.mixture.covariances[static_cast<std::size_t>(k)].topLeftCorner(p, p);
  Eigen::VectorXd weights = mixture.responsibilities.all().row(k).transpose();
  for (Index i = 0; i < weights.size(); ++i)
    if (!std::isfinite(weights(i)) || !fits.parameters.col(i).allFinite()) weights(i) = 0.0;
  const double total = std::max(weights.sum(), std::numeric_limits<double>::min());
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(p);
  for (Index i = 0; i < weights.size(); ++i)
    if (weights(i) > 0.0) mean += weights(i) / total * fits.parameters.col(i);
  Eigen::MatrixXd parameter_covariance = Eigen::MatrixXd::Zero(p, p);
  for (Index i = 0; i < weights.size(); ++i) {
    if (!(weights(i) > 0.0)) continue;
    const Eigen::VectorXd offset = fits.parameters.col(i) - mean;
    parameter_covariance += weights(i) / total * offset * offset.transpose();
  }
  return parameter_covariance;
}

TransitionMatrix learn_transition(const WindowFits& fits, const Eigen::VectorXi& labels, const std::vector<Index>& kept,
                                  const BankOptions& options) {
  if (options.transition == TransitionSource::stay) return TransitionMatrix::sticky(std::ssize(kept), options.stay);
  return transition_from_counts(count_label_transitions(fits, labels, kept), fits.step);
}

/// The mode for the bank. For a motion model, the windows' parameter covariance is converted to the linear parameters.
Mode bank_mode(const LinearStructure& structure, const ComponentEstimate& estimate,
               const Eigen::MatrixXd& parameter_covariance, double weight) {
  const ModeEstimate& linear = estimate.linear;
  if (!estimate.motion)
    return make_mode(structure, linear.theta, linear.Q, parameter_covariance, linear.standard_error, weight);
  const MotionMode& motion = *estimate.motion;
  Mode mode =
      make_mode(structure, linear.theta, linear.Q,
                motion.by_motion * parameter_covariance * motion.by_motion.transpose(), linear.standard_error, weight);
  mode.motion_theta = motion.theta;
  mode.motion_standard_error = motion.standard_error;
  return mode;
}

std::vector<Index> all_positions(Index count) {
  std::vector<Index> positions(count);
  std::iota(positions.begin(), positions.end(), Index{0});
  return positions;
}

/// One mode from all components, used if no component can be a mode. It may be unstable, like the global model that it
/// competes with. Its predictions one step ahead may still be right. The summary warns about the instability.
Bank bank_of_all(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture, BankOptions options,
                 const Bank& without_modes, const MotionModel* motion) {
  options.screen = false;
  Bank bank = learn_bank(recording, fits, merge_components(mixture, 1), options, without_modes.R, motion);
  bank.screened = without_modes.screened;
  return bank;
}

}  // namespace

Bank learn_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                const BankOptions& options, const Eigen::MatrixXd& R, const MotionModel* motion) {
  check(options, fits, mixture);
  const GaussianMixture& components = mixture.mixture;
  const std::vector<ComponentEstimate> estimates =
      estimate_components({recording, fits, mixture, options.theta}, motion);

  Bank bank = bank_frame(recording, fits.structure, stated_or(options, R));
  bank.model = fits.model;
  if (motion) bank.motion_parameters = motion->parameters();
  const std::vector<Index> kept = options.screen ? screen(fits.structure, estimates, components.weights, bank.screened)
                                                 : all_positions(components.components());
  if (kept.empty()) return bank_of_all(recording, fits, mixture, options, bank, motion);
  std::vector<ComponentEstimate> modes;
  modes.reserve(kept.size());
  for (const Index k : kept) modes.push_back(estimates[k]);
  set_process_noise(modes, options);

  const double kept_weight = components.weights(kept).sum();
  for (Index j = 0; j < std::ssize(kept); ++j)
    bank.modes.push_back(bank_mode(fits.structure, modes[j], parameter_covariance_of(fits, mixture, kept[j]),
                                   components.weights(kept[j]) / kept_weight));
  set_mode_sequence(bank, learn_transition(fits, mixture.labels, kept, options));
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
    if (!(left_out_score(with_factor) < without)) refined = std::move(with_factor);
  }
  if (part) refined.learned_transitions = part->transitions(Role::train);
  return refined;
}

Refine refinement_asked(const BankOptions& options, bool linear) {
  if (options.refine != Refine::automatic) return options.refine;
  const bool kept = options.theta != ThetaSource::pooled || options.noise != NoiseSource::per_mode ||
                    options.transition == TransitionSource::stay;
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
