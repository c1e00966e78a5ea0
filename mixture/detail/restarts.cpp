#include "mixture/detail/restarts.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "ident/base/not_a_number.hpp"
#include "mixture/detail/iterate.hpp"
#include "mixture/detail/split_merge.hpp"
#include "mixture/detail/whole_loop.hpp"
#include "mixture/reduction.hpp"

namespace modebank {

namespace {

/// Restarts count as agreeing if their mean log-likelihoods per unit weight differ by less than this [nats].
constexpr double agreement_per_point = 1e-4;
/// Tolerance at which split-and-merge moves begin, because the climb is then near enough to an optimum.
constexpr double coarse_tolerance = 1e-5;

std::size_t best_of(const std::vector<EmResult>& results) {
  return static_cast<std::size_t>(std::max_element(results.begin(), results.end(),
                                                   [](const EmResult& a, const EmResult& b) {
                                                     return is_below(a.log_likelihood, b.log_likelihood);
                                                   }) -
                                  results.begin());
}

EmOptions with_iterations_left(const EmOptions& options, int spent) {
  EmOptions rest = options;
  rest.max_iterations = std::max(0, options.max_iterations - spent);
  return rest;
}

GaussianMixture union_of(const GaussianMixture& a, const GaussianMixture& b) {
  GaussianMixture both = a;
  both.weights.resize(a.components() + b.components());
  both.weights << 0.5 * a.weights, 0.5 * b.weights;
  both.means.resize(a.features(), both.weights.size());
  both.means << a.means, b.means;
  both.covariances.insert(both.covariances.end(), b.covariances.begin(), b.covariances.end());
  both.noise.weight = 0.5 * (a.noise.weight + b.noise.weight);
  return both;
}

/// Climbs from a start to an optimum that no split-and-merge move improves. `spent` is the number of iterations already
/// used.
EmResult climb(const PointBlocks& points, GaussianMixture start, int spent, const EmOptions& options,
               std::uint64_t seed) {
  const EmOptions rest = with_iterations_left(options, spent);
  EmResult result = split_and_merge(points, iterate(points, std::move(start), rest, Steps::extrapolated), rest, seed);
  result.iterations += spent;
  return result;
}

/// Continues EM from the mixture in `result`.
void follow(const PointBlocks& points, const EmOptions& options, double hopeless_below, EmResult& result) {
  const int spent = result.iterations;
  EmResult rest = iterate(points, std::move(result.mixture), with_iterations_left(options, spent), Steps::extrapolated,
                          hopeless_below);
  result = std::move(rest);
  result.iterations += spent;
}

}  // namespace

GaussianMixture cross(const GaussianMixture& a, const GaussianMixture& b) {
  Reduction reduction(union_of(a, b));
  while (reduction.components() > a.components()) reduction.merge_closest();
  return reduction.mixture();
}

EmResult best_of_restarts(const PointBlocks& points, const std::function<GaussianMixture(int)>& start_of,
                          const EmOptions& options, std::uint64_t seed) {
  EmOptions coarse = options;
  if (options.tolerance > 0.0) coarse.tolerance = std::max(options.tolerance, coarse_tolerance);
  std::vector<EmResult> results(static_cast<std::size_t>(options.restarts));
  std::vector<std::optional<EmResult>> crossing(results.size());
  const auto for_each = [&](auto action) {
    tbb::parallel_for(0, options.restarts, [&](int i) { action(static_cast<std::size_t>(i)); });
    require_whole_loop();
  };
  for_each([&](std::size_t i) { results[i] = climb(points, start_of(static_cast<int>(i)), 0, coarse, seed); });
  std::vector<EmResult> alone = results;  // only the optima that each restart found by itself are counted
  std::size_t best = best_of(results);
  if (options.split_merge > 0 && results[best].mixture.components() > 1) {
    for_each([&](std::size_t i) {
      if (i == best) return;
      const int spent = results[i].iterations;
      EmResult crossed = climb(points, cross(results[best].mixture, results[i].mixture), spent, coarse, seed);
      if (crossed.log_likelihood > results[i].log_likelihood) crossing[i] = std::move(crossed);
    });
    for (std::size_t i = 0; i < results.size(); ++i)
      if (crossing[i]) results[i] = std::move(*crossing[i]);
    best = best_of(results);
  }
  const double reach = agreement_per_point * points.total_weight();
  if (coarse.tolerance > options.tolerance) {
    follow(points, options, -std::numeric_limits<double>::infinity(), results[best]);
    const double wanted = results[best].log_likelihood - reach;
    for_each([&](std::size_t i) {
      if (crossing[i]) follow(points, options, wanted, alone[i]);
      if (i != best) follow(points, options, wanted, results[i]);
    });
    best = best_of(results);
  }
  const double agreed = results[best].log_likelihood - reach;
  int agreeing = 0;
  for (std::size_t i = 0; i < results.size(); ++i)
    if ((crossing[i] ? alone[i] : results[i]).log_likelihood >= agreed) ++agreeing;
  EmResult result = std::move(results[best]);
  result.agreeing_restarts = agreeing;
  return result;
}

}  // namespace modebank
