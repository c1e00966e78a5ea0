#include "ident/lag/estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "ident/base/lagged_product.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/lag/objective.hpp"

namespace modebank {

namespace {

using Eigen::Index;
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

/// Variance of the lag at the optimum, by a Gauss-Newton sandwich. NaN if the data do not determine it.
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

constexpr Index coarse_samples = 4000;  // number of averages for a rough search of the minimum
constexpr Index most_samples = 20000;   // number of averages for an exact search of the minimum
constexpr Index coarse_lags = 51;
constexpr int halvings = 12;
constexpr int most_moves = 400;
constexpr double least_evidence_nats = 5.0;  // smallest gain of the best lag over the median of all lags
constexpr double least_r_squared = 0.5;      // if R^2 is smaller, the inputs do not explain the states
constexpr double largest_error = 0.2;        // largest standard error, as a share of the searched range

struct Search {
  double range_s;          // width of the range of lags
  double time_constant_s;  // largest time constant that is searched
};

bool inside(const LagPoint& p, const Search& search) {
  return std::abs(p.lag_s) <= search.range_s && p.time_constant_s >= 0.0 && p.time_constant_s <= search.time_constant_s;
}

double lag_at(Index i, double range_s) {
  return range_s * (2.0 * static_cast<double>(i) / static_cast<double>(coarse_lags - 1) - 1.0);
}

/// 0, then doubling values from half a period to the largest.
std::vector<double> time_constants(const Search& search, double period_s) {
  std::vector<double> values{0.0};
  double tau = 0.5 * period_s;
  while (tau <= search.time_constant_s) {
    values.push_back(tau);
    tau *= 2.0;
  }
  return values;
}

struct GridResult {
  LagPoint best;
  double typical_cost = 0.0;  // median over the lags, each lag with its best time constant
};

GridResult search_lags(const LagObjective& objective, const Search& search) {
  GridResult result;
  double lowest = 0.0;
  std::vector<double> profile(coarse_lags, 0.0);
  for (const double tau : time_constants(search, objective.period_s()))
    for (Index i = 0; i < coarse_lags; ++i) {
      const LagPoint point{lag_at(i, search.range_s), tau};
      const double cost = objective.cost(point);
      profile[static_cast<std::size_t>(i)] = std::min(profile[static_cast<std::size_t>(i)], cost);
      if (cost < lowest) {
        lowest = cost;
        result.best = point;
      }
    }
  std::nth_element(profile.begin(), profile.begin() + coarse_lags / 2, profile.end());
  result.typical_cost = profile[coarse_lags / 2];
  return result;
}

LagPoint moved(LagPoint p, const std::array<double, 2>& direction, double step_s) {
  p.lag_s += direction[0] * step_s;
  p.time_constant_s = std::max(p.time_constant_s + direction[1] * step_s, 0.0);
  return p;
}

/// Pattern search (Hooke & Jeeves 1961) along the axes, and along the direction in which lag plus time constant is
/// constant. The data determine this sum better than the lag or the time constant.
LagPoint refine(const LagObjective& objective, const Search& search, LagPoint point) {
  static constexpr std::array<std::array<double, 2>, 6> directions{
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, -1}, {-1, 1}}};
  double step_s = 2.0 * search.range_s / (coarse_lags - 1);
  double lowest = objective.cost(point);
  for (int halved = 0, moves = 0; halved < halvings && moves < most_moves; ++moves) {
    LagPoint best = point;
    for (const auto& direction : directions) {
      const LagPoint candidate = moved(point, direction, step_s);
      if (!inside(candidate, search)) continue;
      if (const double cost = objective.cost(candidate); cost < lowest) {
        lowest = cost;
        best = candidate;
      }
    }
    const bool improved = best.lag_s != point.lag_s || best.time_constant_s != point.time_constant_s;
    point = best;
    if (improved) continue;
    ++halved;
    step_s *= 0.5;
  }
  return point;
}

/// Effective number of independent samples of the residuals, given their autocorrelation.
double effective_samples(const LagObjective::Fit& fit) {
  double numerator = 0.0, denominator = 0.0;
  const Index N = fit.samples;
  for (Index i = 0; i < fit.residuals.rows(); ++i) {
    const auto r = fit.residuals.row(i);
    const double square_sum = r.squaredNorm();
    if (!(square_sum > 0.0)) continue;
    numerator += lagged_product(r, r, 1) / square_sum;
    denominator += 1.0;
  }
  const double rho = denominator > 0.0 ? std::clamp(numerator / denominator, 0.0, 0.99) : 0.0;
  return static_cast<double>(N) * (1.0 - rho) / (1.0 + rho);
}

LagFit finish(LagObjective& objective, const Search& search, const GridResult& coarse) {
  LagPoint point = coarse.best;
  for (int pass = 0; pass < 3; ++pass) {
    if (pass > 0) objective.reweight(point);
    point = refine(objective, search, point);
  }
  LagFit result;
  result.lag_s = point.lag_s;
  result.time_constant_s = point.time_constant_s;
  result.lag_standard_error_s = std::sqrt(lag_variance_s2(objective, point));
  const auto fit = objective.fit(point);
  const double cost = objective.cost(point);
  result.r_squared = -std::expm1(cost);
  const double states = fit ? static_cast<double>(fit->residuals.rows()) : 0.0;
  const double evidence = fit ? 0.5 * states * effective_samples(*fit) * (coarse.typical_cost - cost) : 0.0;
  const double edge = search.range_s * (1.0 - 1.0 / (coarse_lags - 1));
  if (!(evidence >= least_evidence_nats) || !(result.r_squared >= least_r_squared) ||
      !(result.lag_standard_error_s <= largest_error * search.range_s))
    result.status = LagStatus::not_excited;
  else if (std::abs(point.lag_s) >= edge)
    result.status = LagStatus::at_edge;
  else
    result.status = LagStatus::converged;
  return result;
}

}  // namespace

LagFit estimate_lag(const Stream& states, const Stream& inputs, const LagOptions& options) {
  LagFit unknown;
  unknown.status = LagStatus::not_excited;
  const Stream y = without_missing(states), u = with_last_known(inputs);
  constexpr Index least_samples = 10;
  if (u.values.rows() == 0 || y.time_s.size() < least_samples || u.time_s.size() < least_samples) return unknown;
  const LagObjective coarse(y, u, coarse_samples);
  LagObjective fine(y, u, most_samples);
  Search search;
  search.range_s = std::min(options.range_s, 0.25 * fine.span_s());
  search.time_constant_s = search.range_s;
  if (!(search.range_s > 0.0) || fine.samples() < least_samples) return unknown;
  return finish(fine, search, search_lags(coarse, search));
}

}  // namespace modebank
