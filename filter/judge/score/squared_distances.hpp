#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "filter/judge/run/evaluate.hpp"
#include "filter/judge/score/statistics.hpp"

namespace modebank {

struct Interval {
  double lower, upper;
};

/// Squared distances of single samples relative to the filter's covariance: NIS of the available signals, or NEES of
/// the judged states. If the model is correct, a distance of d signals has mean d. It is chi-square with d degrees of
/// freedom if the prediction is one Gaussian of known variance.
struct SquaredDistances {
  SeriesByRun value;
  SeriesByRun degrees;  ///< degrees of freedom of each distance

  void begin_run();
  /// `d`: degrees of freedom. If `d` is 0, nothing is added.
  void add(double distance, Eigen::Index d);
};

/// Number of scored signals of a sample.
Eigen::Index scored_signals(const RunEvaluation& evaluation, Eigen::Index sample);

/// Sum of distances divided by the sum of degrees, times `of_all`, the degrees of a complete sample. If the model is
/// correct, the mean is therefore `of_all`, even with missing signals. A sample's weight is its degrees. NaN without
/// samples.
double mean_distance(const SquaredDistances& distances, double of_all);

/// Interval that contains mean_distance of a correct model with probability `level`. The sum is treated as chi-square.
/// Its degrees are divided by the autocorrelation time of the distances about their share of the mean, with a margin
/// (cautious_time). Single distances must be chi-square. NaN without samples.
Interval mean_distance_interval(const SquaredDistances& distances, double of_all, double level);

/// NIS of every sample on the scale of all signals, N. So one region applies to all samples. If signals are missing,
/// the NIS is converted to the value for all signals with the same tail probability. NaN if no signal was measured.
Eigen::VectorXd nis_of_all_signals(const RunEvaluation& evaluation);

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
