#include <array>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

constexpr double smallest_r_share = 1e-8;  // limit on the effect of R at its bound on a prediction, as a share of the
                                           // residual variance
constexpr double bound_tolerance = 1e-5;   // nats per sample; largest loss for which R is set to its bound
constexpr double least_gain = 1e-9;        // nats per sample; a start is better only if it gains more than rounding
                                           // errors
constexpr AscentLimits limits{200, 1e-12};
constexpr AscentLimits rough_limits{200, 1e-6};  // limits of the search while starts and bounds are compared
constexpr std::array<std::pair<double, double>, 2> noise_starts{{{1.0, 0.1}, {0.01, 0.5}}};  // starting values, as
                                                                                             // shares of Q and R

/// Lower bound of R's diagonal. An output's noise enters the innovations through the measurement and through each lag,
/// with the squared coefficient of that lag. The bound limits the sum of these effects to a share of the residual
/// variance. A share of var(y) is unsuitable: with clean data and many lags it exceeds the residuals.
Eigen::VectorXd measurement_bound(const LinearStructure& structure, const Eigen::VectorXd& theta,
                                  const Eigen::VectorXd& residual_variance) {
  const Index n = structure.states;
  const Eigen::MatrixXd F = unpack(structure, theta).full_form().topRows(n);
  Eigen::MatrixXd gain = Eigen::MatrixXd::Identity(n, n);
  for (Index lag = 0; lag < structure.state_lags; ++lag) gain += F.middleCols(lag * n, n).cwiseAbs2();
  Eigen::VectorXd bound(n);
  for (Index i = 0; i < n; ++i)
    bound(i) = smallest_r_share * (residual_variance.array() / gain.col(i).array()).minCoeff();
  return bound;
}

/// The search for Q and R. theta is known unless states are rounded; one mode has no T.
struct NoiseSearch {
  LikelihoodTarget target;
  Eigen::VectorXd scale;            ///< n residual variances, the unit of the starts
  Eigen::VectorXd bound;            ///< n lower bounds of R's diagonal
  Eigen::VectorXd theta_unit = {};  ///< p standard errors; empty if theta is known

  double samples() const { return static_cast<double>(target.recording.transitions(Role::train)); }

  LikelihoodMaximum maximise(const Bank& start, const std::vector<Index>& free_R,
                             const AscentLimits& end = rough_limits) const {
    FreeParameters free;
    // an empty vector would count as one column, which means one theta
    if (theta_unit.size() > 0) free.theta_unit = theta_unit;
    free.least_Q = rounding_share * scale;
    free.R = free_R;
    free.least_R = bound;
    free.transition = false;
    return maximise_likelihood(target, free, start, end);
  }
};

/// The likelihood can have one maximum with the noise in Q and another with the noise in R. So several starts are
/// compared. NaN counts as the lowest likelihood.
LikelihoodMaximum best_of_starts(const NoiseSearch& search, Bank bank, const std::vector<Index>& outputs) {
  std::optional<LikelihoodMaximum> best;
  for (const auto& [q_share, r_share] : noise_starts) {
    const Index n = search.scale.size();
    bank.modes.front().Q.topLeftCorner(n, n) = (q_share * search.scale).asDiagonal();
    bank.R = (search.bound + r_share * search.scale).asDiagonal();
    LikelihoodMaximum end = search.maximise(bank, outputs);
    if (!best || is_below(best->value + least_gain * search.samples(), end.value)) best = std::move(end);
  }
  return std::move(*best);
}

struct HeldNoise {
  LikelihoodMaximum best;
  std::vector<Index> free;  ///< outputs whose R is not at its bound
};

/// Sets each output's R to its bound if the likelihood does not become smaller. First tries all outputs at once, with Q
/// of exactly measured states. Then tries the outputs one by one.
HeldNoise hold_at_bounds(const NoiseSearch& search, const Bank& exact, LikelihoodMaximum best,
                         const std::vector<Index>& outputs) {
  const auto costs_nothing = [&](const LikelihoodMaximum& held, const LikelihoodMaximum& free) {
    return held.value >= free.value - bound_tolerance * search.samples();
  };
  Bank start = exact;
  start.R = search.bound.asDiagonal();
  LikelihoodMaximum none = search.maximise(start, {});
  if (costs_nothing(none, best)) return {std::move(none), {}};
  HeldNoise result{std::move(best), outputs};
  for (const Index i : outputs) {
    std::vector<Index> rest = result.free;
    std::erase(rest, i);
    start = result.best.bank;
    start.R(i, i) = search.bound(i);
    LikelihoodMaximum held = search.maximise(start, rest);
    if (costs_nothing(held, result.best)) result = {std::move(held), std::move(rest)};
  }
  return result;
}

}  // namespace

Baseline learn_baseline(const Recording& recording, const GlobalModel& global, const LinearStructure& structure) {
  const Recording training = training_part(recording);
  require_transitions(training.transitions(Role::train) > 0);
  const Index n = structure.states, p = structure.parameters();
  Bank bank = bank_frame(recording, structure, Eigen::MatrixXd::Zero(n, n));
  bank.modes.push_back(make_mode(structure, global.theta, global.residual_covariance, Eigen::MatrixXd::Zero(p, p),
                                 global.covariance.diagonal().cwiseSqrt(), 1.0));
  set_mode_sequence(bank, TransitionMatrix());

  if (structure.state_lags > most_lags_beside_R && !bank.is_quantised())
    return {bank, training_log_likelihood(bank, training, {FilterVariant::kf}), true, true};

  const Eigen::VectorXd scale = global.noise_variance().unaryExpr(&positive_variance);
  NoiseSearch search{{training, {FilterVariant::kf}, std::nullopt},
                     scale,
                     measurement_bound(structure, global.theta, scale).cwiseMax(bank.rounding_variance())};
  if (bank.is_quantised())  // least squares takes rounding for process noise
    search.theta_unit = global.covariance.diagonal().cwiseSqrt().unaryExpr(&positive_variance);
  std::vector<Index> outputs(static_cast<std::size_t>(n));
  std::iota(outputs.begin(), outputs.end(), Index{0});
  HeldNoise noise = hold_at_bounds(search, bank, best_of_starts(search, bank, outputs), outputs);
  noise.best = search.maximise(noise.best.bank, noise.free, limits);
  return {std::move(noise.best.bank), noise.best.value, noise.best.end == MeasuredFit::converged,
          noise.free.size() < outputs.size()};
}

}  // namespace modebank
