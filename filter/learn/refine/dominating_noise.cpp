#include "filter/learn/refine/dominating_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "filter/learn/from_mixture/bank_frame.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/learn/tuning.hpp"

namespace modebank {
namespace {

/// Starting values of R, as shares of the residual variance of exact states. R enters this variance once by the newest
/// sample, and again by every lagged sample.
constexpr std::array<double, 2> R_shares{0.6, 0.25};
constexpr double Q_share = 0.05;
constexpr AscentLimits climb_limits{100, 1e-7};
/// Above this number of state coefficients, a search over all coefficients takes minutes.
constexpr Index most_coefficients = 4;
/// Two lags determine a velocity. With more lags, lag coefficients replace R.
constexpr Index most_lags = 2;

/// One model with the bank's structure and R at these shares.
Bank one_model(const Bank& bank, const GlobalModel& global, double R_share) {
  Bank one = bank;
  const Eigen::VectorXd variance = global.noise_variance().unaryExpr(&positive_variance);
  const Index p = bank.structure.parameters();
  one.modes = {make_mode(bank.structure, global.theta, Q_share * global.residual_covariance,
                         Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p), 1.0)};
  one.transition_logit = {};
  set_mode_sequence(one, TransitionMatrix());
  one.R = (R_share * variance).asDiagonal();
  return one;
}

LikelihoodMaximum climb(const RefineInput& in, const Recording& recording, const GlobalModel& global,
                        const Bank& start) {
  FreeParameters free;
  free.theta_unit = global.covariance.diagonal().cwiseSqrt().unaryExpr(&positive_variance);
  free.R.resize(static_cast<std::size_t>(start.R.rows()));
  std::iota(free.R.begin(), free.R.end(), Index{0});
  free.least_R = least_measurement_noise(in.fits, refine_tuning);
  free.transition = false;
  return maximise_likelihood({recording, exact_filter(in.filter), std::nullopt}, free, start, climb_limits);
}

}  // namespace

std::optional<Bank> start_of_dominating_noise(const RefineInput& in, const Recording& recording,
                                              const GlobalModel& global, const Bank& bank) {
  if (bank.is_quantised() || !global.covariance.allFinite() || bank.structure.state_lags > most_lags ||
      bank.structure.states * bank.structure.dimension() > most_coefficients)
    return std::nullopt;
  std::optional<LikelihoodMaximum> best;
  for (const double share : R_shares) {
    LikelihoodMaximum end = climb(in, recording, global, one_model(bank, global, share));
    if (std::isfinite(end.value) && (!best || end.value > best->value)) best = std::move(end);
  }
  const Index n = bank.structure.states;
  Bank exact = one_model(bank, global, 0.0);
  exact.R = least_measurement_noise(in.fits, refine_tuning).asDiagonal();
  exact.modes.front().Q.topLeftCorner(n, n) = global.residual_covariance;
  const auto samples = static_cast<double>(recording.transitions(Role::train));
  const LikelihoodTarget likelihood{recording, exact_filter(in.filter), std::nullopt};
  if (!best || !(best->value > likelihood.value(exact) + samples * refine_tuning.least_gain)) return std::nullopt;
  const Eigen::MatrixXd Q = best->bank.modes.front().Q.topLeftCorner(n, n);
  if (!(best->bank.R.diagonal().array() > Q.diagonal().array()).any()) return std::nullopt;
  const Eigen::VectorXd moved = best->bank.theta(0) - global.theta;
  const double left = Q.trace() / std::max(global.residual_covariance.trace(), positive_variance(0.0));
  Bank start = bank;
  start.R = best->bank.R;
  for (Index j = 0; j < bank.mode_count(); ++j) {
    Mode& mode = start.modes[static_cast<std::size_t>(j)];
    mode.model = unpack(bank.structure, bank.theta(j) + moved);
    mode.Q *= left;
  }
  return start;
}

}  // namespace modebank
