#pragma once

#include <array>
#include <cstddef>

#include "filter/judge/score/squared_distances.hpp"

namespace modebank {

/// The central bands whose coverage is counted, and which of them decides.
inline constexpr std::array<double, 4> coverage_levels{0.50, 0.90, 0.95, 0.99};
inline constexpr std::size_t deciding_level = 2;

/// Share of a true filter's samples beyond each of the two quantiles by which fractions are counted.
inline constexpr double true_tail = 0.025;

/// Where a normal score z lies: whatever counts coverage or tails asks here.
class ScoreBands {
 public:
  struct Hits {
    std::array<bool, coverage_levels.size()> outside;  ///< of each central band
    bool far, close;                                   ///< z^2 beyond the upper or lower true_tail of chi-square(1)
  };
  ScoreBands();
  Hits of(double z) const;

 private:
  std::array<double, coverage_levels.size()> edges_{};  ///< of |z|: normal quantiles
  double near_square_, far_square_;
};

/// Limits of the probability behind `count` successes in `samples` independent trials, Clopper & Pearson (1934).
/// Fractions of trials are allowed. NaN without samples.
Interval binomial_interval(double count, double samples, double level = 0.95);

}  // namespace modebank
