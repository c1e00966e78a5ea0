#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "filter/bank_frame.hpp"
#include "filter/learn.hpp"
#include "filter/memberships.hpp"
#include "filter/pooled_modes.hpp"
#include "filter/screening.hpp"
#include "filter/transition_learning.hpp"
#include "ident/error.hpp"

namespace modebank {
namespace {

void check(const BankOptions& options, const WindowFits& fits, const MixtureResult& mixture) {
  if (mixture.mixture.components() < 1 || mixture.mixture.features() < fits.parameter_count())
    throw std::invalid_argument("the mixture's features do not begin with the model's parameters");
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

/// [S25]'s way: theta is the component's mean, and Q is taken about that mean.
std::vector<ModeEstimate> modes_at_means(const TrainingTransitions& transitions, const Eigen::MatrixXd& memberships,
                                         const WindowFits& fits, const ParameterPrior* prior,
                                         const GaussianMixture& mixture) {
  std::vector<ModeEstimate> modes;
  modes.reserve(mixture.components());
  for (Index k = 0; k < mixture.components(); ++k)
    modes.push_back(assess_weighted_mode(transitions, memberships.col(k), fits.global, prior,
                                         mixture.means.col(k).head(fits.parameter_count())));
  return modes;
}

std::vector<ModeEstimate> estimate_modes(const Recording& recording, const WindowFits& fits,
                                         const MixtureResult& mixture, ThetaSource source) {
  const TrainingTransitions transitions = gather_training_transitions(recording, fits.structure);
  const Eigen::MatrixXd memberships = transition_memberships(transitions, fits, mixture);
  const std::optional<ParameterPrior> prior = prior_of(fits);
  const ParameterPrior* prior_or_null = prior ? &*prior : nullptr;
  if (source == ThetaSource::mean)
    return modes_at_means(transitions, memberships, fits, prior_or_null, mixture.mixture);
  return fit_pooled_modes(transitions, memberships, fits.global, prior_or_null);
}

/// Positions of the components that become modes; the others are listed in `screened`.
std::vector<Index> screen(const LinearStructure& structure, const std::vector<ModeEstimate>& modes,
                          const Eigen::VectorXd& weights, std::vector<ScreenedMode>& screened) {
  std::vector<Index> kept;
  for (Index k = 0; k < std::ssize(modes); ++k) {
    const std::string reason = screening_reason(structure, modes[k]);
    if (reason.empty())
      kept.push_back(k);
    else
      screened.push_back({k, weights(k), spectral_radius(unpack(structure, modes[k].theta)), reason});
  }
  if (kept.empty()) throw DataError("no mode is left for the bank: " + describe(screened));
  return kept;
}

/// Where Q of the bank's modes comes from. theta and its errors always rest on the mode's own noise.
void set_process_noise(std::vector<ModeEstimate>& modes, const BankOptions& options) {
  const Index n = modes.front().Q.rows();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  double weight = 0.0;
  for (const ModeEstimate& mode : modes) {
    sum += mode.effective_transitions * mode.Q;
    weight += mode.effective_transitions;
  }
  for (ModeEstimate& mode : modes) {
    if (options.noise == NoiseSource::shared) mode.Q = sum / weight;
    if (options.noise == NoiseSource::fixed) mode.Q = options.process_variance * Eigen::MatrixXd::Identity(n, n);
  }
}

TransitionMatrix learn_transition(const WindowFits& fits, const Eigen::VectorXi& labels, const std::vector<Index>& kept,
                                  const BankOptions& options) {
  if (options.transition == TransitionSource::stay) return TransitionMatrix::sticky(std::ssize(kept), options.stay);
  return transition_from_counts(count_label_transitions(fits, labels, kept), fits.step);
}

std::vector<Index> all_positions(Index count) {
  std::vector<Index> positions(count);
  std::iota(positions.begin(), positions.end(), Index{0});
  return positions;
}

}  // namespace

Bank learn_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                const BankOptions& options, const Eigen::MatrixXd& R) {
  check(options, fits, mixture);
  const GaussianMixture& components = mixture.mixture;
  const std::vector<ModeEstimate> estimates = estimate_modes(recording, fits, mixture, options.theta);

  Bank bank = bank_frame(recording, fits.structure, R);
  if (options.measurement_variance)
    bank.R = *options.measurement_variance * Eigen::MatrixXd::Identity(bank.R.rows(), bank.R.cols());
  const std::vector<Index> kept = options.screen ? screen(fits.structure, estimates, components.weights, bank.screened)
                                                 : all_positions(components.components());
  std::vector<ModeEstimate> modes;
  modes.reserve(kept.size());
  for (const Index k : kept) modes.push_back(estimates[k]);
  set_process_noise(modes, options);

  const Index p = fits.parameter_count();
  const double kept_weight = components.weights(kept).sum();
  for (Index j = 0; j < std::ssize(kept); ++j)
    bank.modes.push_back({unpack(fits.structure, modes[j].theta), modes[j].Q,
                          components.covariances[kept[j]].topLeftCorner(p, p), modes[j].standard_error,
                          components.weights(kept[j]) / kept_weight});
  set_mode_sequence(bank, learn_transition(fits, mixture.labels, kept, options));
  return bank;
}

}  // namespace modebank
