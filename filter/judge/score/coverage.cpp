#include "filter/judge/score/coverage.hpp"

#include <algorithm>
#include <cmath>

#include "ident/base/distributions.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

Interval binomial_interval(double count, double samples, double level) {
  if (!(samples > 0.0)) return {not_a_number, not_a_number};
  const double misses = std::max(0.0, samples - count), beyond = 0.5 * (1.0 - level);
  return {count > 0.0 ? beta_quantile(beyond, count, misses + 1.0) : 0.0,
          misses > 0.0 ? beta_quantile(1.0 - beyond, count + 1.0, misses) : 1.0};
}

ScoreBands::ScoreBands()
    : near_square_(chi_square_quantile(true_tail, 1.0)), far_square_(chi_square_quantile(1.0 - true_tail, 1.0)) {
  for (std::size_t b = 0; b < edges_.size(); ++b) edges_[b] = normal_quantile(0.5 + 0.5 * coverage_levels[b]);
}

ScoreBands::Hits ScoreBands::of(double z) const {
  Hits hits{{}, z * z > far_square_, z * z < near_square_};
  for (std::size_t b = 0; b < edges_.size(); ++b) hits.outside[b] = std::abs(z) > edges_[b];
  return hits;
}

}  // namespace modebank
