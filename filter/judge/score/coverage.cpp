#include "filter/judge/score/coverage.hpp"

#include <algorithm>

#include "ident/base/distributions.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

Interval binomial_interval(double count, double samples, double level) {
  if (!(samples > 0.0)) return {not_a_number, not_a_number};
  const double misses = std::max(0.0, samples - count), beyond = 0.5 * (1.0 - level);
  return {count > 0.0 ? beta_quantile(beyond, count, misses + 1.0) : 0.0,
          misses > 0.0 ? beta_quantile(1.0 - beyond, count + 1.0, misses) : 1.0};
}

std::array<double, coverage_levels.size()> coverage_band_edges() {
  std::array<double, coverage_levels.size()> edges{};
  for (std::size_t b = 0; b < edges.size(); ++b) edges[b] = normal_quantile(0.5 + 0.5 * coverage_levels[b]);
  return edges;
}

}  // namespace modebank
