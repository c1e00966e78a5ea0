// The linear stage's model as a bank of one mode.
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <optional>
#include <vector>

#include "filter/learn/chain/stages.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "ident/base/covariance.hpp"
#include "ident/base/seed.hpp"

namespace modebank {
namespace {

/// theta of LinearStructure, which orders inputs by lags first and predicts the increment.
struct Parameters {
  LinearStructure structure;
  Eigen::VectorXd theta;
  Eigen::MatrixXd covariance;
};

std::vector<Index> columns_of(const LinearStructure& s) {
  std::vector<Index> columns;
  for (Index j = 0; j < s.dimension(); ++j) columns.push_back(j);
  for (Index lag = 0; lag < s.input_lags; ++lag)
    for (Index i = 0; i < s.inputs; ++i) columns.push_back(s.dimension() + i * s.input_lags + lag);
  if (s.intercept) columns.push_back(s.dimension() + s.acting_inputs());
  return columns;
}

Parameters parameters_of(const ArmaxFit& fit) {
  const Index n = fit.theta.rows(), m = std::ssize(fit.delays), all = fit.covariance.rows() / n;
  Parameters result;
  result.structure = {n,
                      m,
                      fit.order.has_constant(),
                      fit.order.state_lags,
                      std::max<Index>(1, fit.order.input_lags),
                      InputDelays(fit.delays)};
  const std::vector<Index> columns = columns_of(result.structure);
  Eigen::MatrixXd rows = fit.theta(Eigen::all, columns);
  rows.leftCols(n) -= Eigen::MatrixXd::Identity(n, n);
  result.theta = rows.reshaped<Eigen::RowMajor>();
  std::vector<Index> at;
  for (Index i = 0; i < n; ++i)
    for (const Index column : columns) at.push_back(i * all + column);
  result.covariance = fit.covariance(at, at);
  return result;
}

/// Standard deviations of R's diagonal (n), from draws of theta, C and the covariance of the errors.
Eigen::VectorXd errors_of_R(const ArmaxFit& fit, const std::optional<Eigen::VectorXd>& stated_R) {
  constexpr Index draws = 200;
  const Index n = fit.theta.rows(), q = fit.theta.cols(), p = fit.covariance.rows();
  const Eigen::MatrixXd root = covariance_root(fit.covariance);
  std::mt19937_64 generator = make_generator(1, "noises of the linear stage");
  boost::random::normal_distribution<double> normal;
  Eigen::MatrixXd drawn(n, draws);
  for (Index d = 0; d < draws; ++d) {
    const Eigen::VectorXd z = Eigen::VectorXd::NullaryExpr(root.cols(), [&] { return normal(generator); });
    const Eigen::MatrixXd moved = (root * z).reshaped<Eigen::RowMajor>(n, p / n);
    ArmaxFit other = fit;
    other.theta += moved.leftCols(q);
    for (std::size_t j = 0; j < other.C.size(); ++j) other.C[j] += moved.middleCols(q + static_cast<Index>(j) * n, n);
    const Eigen::VectorXd size = Eigen::VectorXd::NullaryExpr(
        n, [&] { return 1.0 + normal(generator) / std::sqrt(2.0 * static_cast<double>(fit.rows)); });
    other.S = size.asDiagonal() * fit.S * size.asDiagonal();
    drawn.col(d) = noises(other, stated_R).R;
  }
  const Eigen::MatrixXd about = drawn.colwise() - drawn.rowwise().mean();
  return (about.rowwise().squaredNorm() / static_cast<double>(draws - 1)).cwiseSqrt();
}

}  // namespace

Bank bank_of(const Recording& recording, const ArmaxFit& fit, std::optional<double> variance) {
  std::optional<Eigen::VectorXd> stated_R;
  if (variance) stated_R.emplace(Eigen::VectorXd::Constant(recording.state_count(), *variance));
  const Eigen::VectorXd R = noises(fit, stated_R).R;
  // Q of the model's own equation: a level that wanders is noise of the equation with a pole at 1, beside the plant's.
  const ArmaxFit equation = in_levels(fit);
  const Eigen::VectorXd Q = noises(equation, R).Q;
  const Parameters own = parameters_of(fit), levels = parameters_of(equation);
  const Index p = levels.structure.parameters();
  Bank bank = bank_frame(recording, levels.structure, R.asDiagonal());
  bank.model = levels.structure.lagged() ? "varx" : "linear";
  bank.modes.push_back(make_mode(levels.structure, levels.theta, Q.asDiagonal(), Eigen::MatrixXd::Zero(p, p),
                                 levels.covariance.diagonal().cwiseMax(0.0).cwiseSqrt(), 1.0));
  if (!fit.delays.empty())
    bank.modes[0].response = step_response(own.structure, own.theta, own.covariance, fit.delays, bank.dt_s);
  bank.R_standard_error = errors_of_R(fit, stated_R).asDiagonal();
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
