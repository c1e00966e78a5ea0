#pragma once

#include <array>
#include <cstddef>

#include "filter/judge/score/squared_distances.hpp"

namespace modebank {

/// Levels of the central bands whose coverage is counted, and the level that decides.
inline constexpr std::array<double, 4> coverage_levels{0.50, 0.90, 0.95, 0.99};
inline constexpr std::size_t deciding_level = 2;

/// Probability of each of the two tails if the model is correct.
inline constexpr double true_tail = 0.025;

/// Classifies a normal score z by bands and tails. All counts of coverage and tails use it.
class ScoreBands {
 public:
  struct Hits {
    std::array<bool, coverage_levels.size()> outside;  ///< whether |z| lies outside each central band
    bool far, close;                                   ///< whether z^2 is above the upper, or below the lower true_tail
                                                       ///< quantile of chi-square(1)
  };
  ScoreBands();
  Hits of(double z) const;

 private:
  std::array<double, coverage_levels.size()> edges_{};  ///< limits of |z|: normal quantiles
  double near_square_, far_square_;
};

/// Confidence limits of a probability from `count` successes in `samples` independent trials (Clopper & Pearson 1934).
/// Fractional counts are allowed. NaN without samples.
Interval binomial_interval(double count, double samples, double level = 0.95);

}  // namespace modebank
