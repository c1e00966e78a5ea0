#include "ident/lag/estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "ident/base/lagged_product.hpp"
#include "ident/lag/objective.hpp"
#include "ident/lag/uncertainty.hpp"

namespace modebank {

namespace {

using Eigen::Index;

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
