// The linear stage's model as a bank of one mode.
#include <algorithm>
#include <optional>
#include <vector>

#include "filter/learn/chain/stages.hpp"
#include "filter/learn/from_mixture/bank.hpp"

namespace modebank {
namespace {

/// theta of LinearStructure, which predicts the increment.
struct Parameters {
  LinearStructure structure;
  Eigen::VectorXd theta;
  Eigen::MatrixXd covariance;
};

Parameters parameters_of(const ArmaxFit& fit) {
  const Index n = fit.theta.rows(), P = fit.theta.cols(), all = fit.covariance.rows() / n;
  const ArmaxOrder& order = fit.order;
  const LinearStructure structure{n,
                                  std::ssize(fit.delays),
                                  order.has_constant(),
                                  order.state_lags,
                                  std::max<Index>(1, order.input_lags),
                                  InputDelays(fit.delays)};
  std::vector<Index> at;
  for (Index i = 0; i < n; ++i)
    for (Index column = 0; column < P; ++column) at.push_back(i * all + column);
  const Eigen::MatrixXd increments = fit.theta - Eigen::MatrixXd::Identity(n, P);
  return {structure, increments.reshaped<Eigen::RowMajor>(), fit.covariance(at, at)};
}

/// The same model in levels: differences get a pole at 1, one more lag and no constant.
ArmaxFit in_levels(const ArmaxFit& fit) {
  if (!fit.order.differences) return fit;
  const Index n = fit.theta.rows(), m = std::ssize(fit.delays);
  ArmaxFit levels = fit;
  levels.order.differences = false;
  levels.order.intercept = false;
  levels.order.state_lags += 1;
  if (m > 0) levels.order.input_lags += 1;
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

}  // namespace

Bank bank_of(const Recording& recording, const ArmaxFit& fit, std::optional<double> variance) {
  std::optional<Eigen::VectorXd> stated_R;
  if (variance) stated_R.emplace(Eigen::VectorXd::Constant(recording.state_count(), *variance));
  const NoiseVariances noise = noise_variances(fit, stated_R);
  // Q of the model's own equation: a level that wanders is noise of the equation with a pole at 1, beside the plant's.
  const ArmaxFit equation = in_levels(fit);
  const Eigen::VectorXd Q = noise_variances(equation, noise.R).Q;
  const Parameters own = parameters_of(fit), levels = parameters_of(equation);
  const Index p = levels.structure.parameters();
  Bank bank = bank_frame(recording, levels.structure, noise.R.asDiagonal());
  bank.model = levels.structure.lagged() ? "varx" : "linear";
  bank.modes.push_back(make_mode(levels.structure, levels.theta, Q.asDiagonal(), Eigen::MatrixXd::Zero(p, p),
                                 levels.covariance.diagonal().cwiseMax(0.0).cwiseSqrt(), 1.0));
  if (!fit.delays.empty())
    bank.modes[0].response = step_response(own.structure, own.theta, own.covariance, fit.delays, bank.dt_s);
  bank.R_standard_error = noise.R_error.asDiagonal();
  set_mode_sequence(bank, TransitionMatrix());
  return bank;
}

std::optional<Bank> learn_armax(const Recording& recording, const ArmaxStructure& structure,
                                std::optional<double> variance) {
  const LinearStage stage = find_linear_stage(recording, {.only = structure});
  if (stage.candidates.empty()) return {};
  return bank_of(recording, stage.fit(), variance);
}

}  // namespace modebank
