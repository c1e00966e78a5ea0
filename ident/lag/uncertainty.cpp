#include "ident/lag/uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// Bandwidth of the Bartlett kernel, in samples.
Index bandwidth(const MatrixXd& scores) {
  const Index N = scores.cols();
  double numerator = 0.0, denominator = 0.0;
  for (Index i = 0; i < scores.rows(); ++i) {
    const auto now = scores.row(i).tail(N - 1), before = scores.row(i).head(N - 1);
    const double square_sum = before.squaredNorm();
    if (!(square_sum > 0.0)) continue;
    const double rho = std::clamp(now.dot(before) / square_sum, -0.97, 0.97);
    // Each score is in units of its innovations' standard deviation, so that physical units do not matter.
    numerator += 4.0 * rho * rho / (std::pow(1.0 - rho, 6) * std::pow(1.0 + rho, 2));
    denominator += 1.0 / std::pow(1.0 - rho, 4);
  }
  if (!(denominator > 0.0)) return 0;
  const double width = 1.1447 * std::cbrt(numerator / denominator * static_cast<double>(N));
  return std::min(static_cast<Index>(std::ceil(width)), N / 4);
}

/// d(prediction) / d(parameter) by central differences, n x samples.
MatrixXd slope(const LagObjective& objective, const LagObjective::Fit& fit, LagPoint low, LagPoint high,
               double distance) {
  return fit.coefficients * (objective.inputs_at(high, fit) - objective.inputs_at(low, fit)) / distance;
}

/// The part of `row` that a regression on the inputs and a constant does not explain.
RowVectorXd unexplained_part(const MatrixXd& inputs, const VectorXd& weights, const RowVectorXd& row) {
  MatrixXd X(inputs.rows() + 1, inputs.cols());
  X << inputs, RowVectorXd::Ones(inputs.cols());
  const MatrixXd XW = X * weights.asDiagonal();
  const VectorXd beta = PivotedLu(XW * X.transpose()).solve(VectorXd(XW * row.transpose()));
  return row - beta.transpose() * X;
}

/// One state's part of the whitened nonlinear problem: slopes orthogonal to the linear part, residuals, and weights.
struct StateTerms {
  MatrixXd J;            // slopes, q x samples
  RowVectorXd residual;  // weighted
};

std::vector<StateTerms> state_terms(const LagObjective::Fit& fit, const std::vector<MatrixXd>& slopes) {
  std::vector<StateTerms> terms;
  for (Index i = 0; i < fit.residuals.rows(); ++i) {
    const RowVectorXd weighted = fit.residuals.row(i).cwiseProduct(fit.weights.transpose());
    const double variance = weighted.dot(fit.residuals.row(i)) / fit.weights.sum();
    if (!(variance > 0.0)) continue;
    StateTerms& state = terms.emplace_back();
    state.J.resize(static_cast<Index>(slopes.size()), fit.samples);
    for (std::size_t j = 0; j < slopes.size(); ++j)
      state.J.row(static_cast<Index>(j)) = unexplained_part(fit.inputs, fit.weights, slopes[j].row(i));
    state.J /= std::sqrt(variance);
    state.residual = weighted / std::sqrt(variance);
  }
  return terms;
}

/// Long-run covariance of the scores (q x N): their autocovariances, summed over lags with Bartlett weights (Newey &
/// West 1987). Bandwidth by Andrews (1991), eq. 6.2 and 6.4, for first-order autoregressions.
MatrixXd long_run_sum(const MatrixXd& scores) {
  const Index N = scores.cols(), width = N > 1 ? bandwidth(scores) : 0;
  MatrixXd sum = scores * scores.transpose();
  for (Index lag = 1; lag <= width; ++lag) {
    const MatrixXd part = scores.rightCols(N - lag) * scores.leftCols(N - lag).transpose();
    sum += (1.0 - static_cast<double>(lag) / static_cast<double>(width + 1)) * (part + part.transpose());
  }
  return sum;
}

/// H^-1 S H^-1, with residuals scaled up according to their leverage (HC3). The scaling is needed because a single ramp
/// of the inputs can contain all of the information. Empty if the information H is singular.
MatrixXd sandwich(const LagObjective::Fit& fit, const std::vector<MatrixXd>& slopes) {
  constexpr double largest_leverage = 0.99;
  const auto q = static_cast<Index>(slopes.size());
  const std::vector<StateTerms> terms = state_terms(fit, slopes);
  MatrixXd information = MatrixXd::Zero(q, q);
  for (const StateTerms& state : terms) information += state.J * fit.weights.asDiagonal() * state.J.transpose();
  const PivotedLu lu(information);
  if (!lu.invertible()) return {};
  const MatrixXd inverse = lu.inverse();
  MatrixXd scores = MatrixXd::Zero(q, fit.samples);
  for (const StateTerms& state : terms) {
    const RowVectorXd leverage =
        (state.J.cwiseProduct(inverse * state.J)).colwise().sum().cwiseProduct(fit.weights.transpose());
    const RowVectorXd residual = state.residual.array() / (1.0 - leverage.array().min(largest_leverage));
    scores += state.J * residual.asDiagonal();
  }
  return inverse * long_run_sum(scores) * inverse;
}

}  // namespace

double lag_variance_s2(const LagObjective& objective, const LagPoint& point) {
  const auto fit = objective.fit(point);
  if (!fit || !(objective.span_s() > 0.0)) return not_a_number;
  const double step_s = 0.5 * objective.period_s();
  std::vector<MatrixXd> slopes;
  LagPoint low = point, high = point;
  low.lag_s -= step_s, high.lag_s += step_s;
  slopes.push_back(slope(objective, *fit, low, high, 2.0 * step_s));
  if (point.time_constant_s > 0.0) {  // else it is at its bound, and has no error
    low = high = point;
    const double tau_step_s = std::min(step_s, 0.5 * point.time_constant_s);
    low.time_constant_s -= tau_step_s, high.time_constant_s += tau_step_s;
    slopes.push_back(slope(objective, *fit, low, high, 2.0 * tau_step_s));
  }
  const MatrixXd covariance = sandwich(*fit, slopes);
  return covariance.size() == 0 ? not_a_number : covariance(0, 0);
}

}  // namespace modebank
