// The competitor `baseline`: one Kalman filter, of least squares or of the linear stage.
#include <numeric>
#include <utility>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"

namespace modebank {
namespace {

/// Lower bound of R's diagonal. An output's noise enters the innovations directly and through each lag, with the
/// squared coefficient of that lag. The sum of these effects is limited to a share of the residual variance. (A share
/// of var(y) exceeds the residuals, with clean data and many lags.)
Eigen::VectorXd measurement_bound(const LinearStructure& structure, const Eigen::VectorXd& theta,
                                  const Eigen::VectorXd& residual_variance) {
  constexpr double share = 1e-8;
  const Index n = structure.states;
  const Eigen::MatrixXd F = unpack(structure, theta).full_form().topRows(n);
  Eigen::MatrixXd gain = Eigen::MatrixXd::Identity(n, n);
  for (Index lag = 0; lag < structure.state_lags; ++lag) gain += F.middleCols(lag * n, n).cwiseAbs2();
  return share * (gain.cwiseInverse().transpose() * residual_variance.asDiagonal()).rowwise().minCoeff();
}

/// The search for Q and R. theta is known unless states are rounded; one mode has no T.
struct NoiseSearch {
  LikelihoodTarget target;
  FreeParameters free;
  Eigen::VectorXd scale;  ///< n residual variances, the unit of the starts
  double samples;

  LikelihoodMaximum maximise(const Bank& start, const std::vector<Index>& outputs, double tolerance = 1e-6) const {
    FreeParameters all = free;
    all.R = outputs;
    return maximise_likelihood(target, all, start, {200, tolerance});
  }

  /// The likelihood can have one maximum with the noise in Q and another with the noise in R. So several starts are
  /// compared. NaN counts as the lowest likelihood.
  LikelihoodMaximum best_of_starts(Bank bank, const std::vector<Index>& outputs) const {
    constexpr std::array<std::pair<double, double>, 2> shares_of_Q_and_R{{{1.0, 0.1}, {0.01, 0.5}}};
    constexpr double rounding = 1e-9;  // nats per sample
    std::optional<LikelihoodMaximum> best;
    for (const auto& [q_share, r_share] : shares_of_Q_and_R) {
      bank.modes.front().Q.topLeftCorner(scale.size(), scale.size()) = (q_share * scale).asDiagonal();
      bank.R = (free.least_R + r_share * scale).asDiagonal();
      LikelihoodMaximum end = maximise(bank, outputs);
      if (!best || is_below(best->value + rounding * samples, end.value)) best = std::move(end);
    }
    return std::move(*best);
  }

  /// Sets each output's R to its bound if the likelihood does not become smaller. First tries all outputs at once, with
  /// Q of exactly measured states, then the outputs one by one. `outputs` are then those whose R is not at its bound.
  LikelihoodMaximum hold_at_bounds(Bank exact, LikelihoodMaximum best, std::vector<Index>& outputs) const {
    constexpr double tolerance = 1e-5;  // nats per sample
    const auto costs_nothing = [&](const LikelihoodMaximum& held) {
      return held.value >= best.value - tolerance * samples;
    };
    exact.R = free.least_R.asDiagonal();
    if (LikelihoodMaximum none = maximise(exact, {}); costs_nothing(none)) {
      outputs.clear();
      return none;
    }
    for (const Index i : std::vector<Index>(outputs)) {
      std::vector<Index> rest = outputs;
      std::erase(rest, i);
      Bank start = best.bank;
      start.R(i, i) = free.least_R(i);
      if (LikelihoodMaximum held = maximise(start, rest); costs_nothing(held)) {
        best = std::move(held);
        outputs = std::move(rest);
      }
    }
    return best;
  }
};

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
  FreeParameters free;
  if (bank.is_quantised())  // least squares takes rounding for process noise
    free.theta_unit = global.covariance.diagonal().cwiseSqrt().unaryExpr(&positive_variance);
  free.least_Q = rounding_share * scale;
  free.least_R = measurement_bound(structure, global.theta, scale).cwiseMax(bank.rounding_variance());
  free.transition = false;
  const NoiseSearch search{{training, {FilterVariant::kf}, std::nullopt},
                           free,
                           scale,
                           static_cast<double>(training.transitions(Role::train))};
  std::vector<Index> outputs(static_cast<std::size_t>(n));
  std::iota(outputs.begin(), outputs.end(), Index{0});
  const LikelihoodMaximum rough = search.hold_at_bounds(bank, search.best_of_starts(bank, outputs), outputs);
  LikelihoodMaximum end = search.maximise(rough.bank, outputs, 1e-12);
  return {std::move(end.bank), end.value, end.end == MeasuredFit::converged, std::ssize(outputs) < n};
}

namespace {

/// The model in levels: differences get a pole at 1, one more lag and no constant.
ArmaxFit in_levels(const ArmaxFit& fit) {
  if (!fit.order.differences) return fit;
  const Index n = fit.theta.rows(), m = std::ssize(fit.delays);
  ArmaxFit levels = fit;
  levels.order = {false, fit.order.state_lags + 1, fit.order.input_lags + (m > 0 ? 1 : 0), fit.order.noise_lags, false};
  const Index states = n * fit.order.state_lags, inputs = m * fit.order.input_lags, noise = n * fit.order.noise_lags;
  const Index q = states + inputs + noise;
  // (1 - q^-1) A(q), (1 - q^-1) B(q): each row of [theta C] times M, plus an identity.
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(q, q + n + m);
  M.topLeftCorner(states, states).setIdentity();
  M.block(0, n, states, states) -= Eigen::MatrixXd::Identity(states, states);
  M.block(states, states + n, inputs, inputs).setIdentity();
  M.block(states, states + n + m, inputs, inputs) -= Eigen::MatrixXd::Identity(inputs, inputs);
  M.bottomRightCorner(noise, noise).setIdentity();
  levels.theta = fit.theta * M.topLeftCorner(fit.theta.cols(), M.cols() - noise);
  levels.theta.leftCols(n) += Eigen::MatrixXd::Identity(n, n);
  levels.covariance.resize(n * M.cols(), n * M.cols());
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      levels.covariance.block(i * M.cols(), j * M.cols(), M.cols(), M.cols()) =
          M.transpose() * fit.covariance.block(i * q, j * q, q, q) * M;
  return levels;
}

LinearStructure structure_of(const ArmaxFit& fit) {
  return {fit.theta.rows(),
          std::ssize(fit.delays),
          fit.order.has_constant(),
          fit.order.state_lags,
          std::max<Index>(1, fit.order.input_lags),
          InputDelays(fit.delays)};
}

/// theta of structure_of, which predicts the increment, and its covariance.
std::pair<Eigen::VectorXd, Eigen::MatrixXd> increments_of(const ArmaxFit& fit) {
  const Index n = fit.theta.rows(), P = fit.theta.cols(), all = fit.covariance.rows() / n;
  std::vector<Index> at;
  for (Index i = 0; i < n; ++i)
    for (Index column = 0; column < P; ++column) at.push_back(i * all + column);
  const Eigen::MatrixXd increments = fit.theta - Eigen::MatrixXd::Identity(n, P);
  return {increments.reshaped<Eigen::RowMajor>(), fit.covariance(at, at)};
}

}  // namespace

Bank bank_of(const Recording& recording, const ArmaxFit& fit, std::optional<double> variance) {
  std::optional<Eigen::VectorXd> stated_R;
  if (variance) stated_R.emplace(Eigen::VectorXd::Constant(recording.state_count(), *variance));
  const NoiseVariances noise = noise_variances(fit, stated_R);
  // Q of the model's own equation: a level that wanders is noise of the equation with a pole at 1, beside the plant's.
  const ArmaxFit levels = in_levels(fit);
  const LinearStructure structure = structure_of(levels);
  const auto [theta, covariance] = increments_of(levels);
  Bank bank = bank_frame(recording, structure, noise.R.asDiagonal());
  bank.model = structure.lagged() ? "varx" : "linear";
  bank.modes.push_back(make_mode(structure, theta, noise_variances(levels, noise.R).Q.asDiagonal(),
                                 Eigen::MatrixXd::Zero(theta.size(), theta.size()),
                                 covariance.diagonal().cwiseMax(0.0).cwiseSqrt(), 1.0));
  if (!fit.delays.empty()) {
    const auto [own, own_covariance] = increments_of(fit);
    bank.modes[0].response = step_response(structure_of(fit), own, own_covariance, fit.delays, bank.dt_s);
  }
  bank.R_standard_error = noise.R_error.asDiagonal();
  set_mode_sequence(bank, TransitionMatrix());
  return bank;
}

std::optional<Bank> learn_armax(const Recording& recording, const ArmaxStructure& structure,
                                std::optional<double> variance) {
  const LinearStage stage = find_linear_stage(recording, {.only = structure});
  return stage.candidates.empty() ? std::nullopt : std::optional(bank_of(recording, stage.fit(), variance));
}

}  // namespace modebank
