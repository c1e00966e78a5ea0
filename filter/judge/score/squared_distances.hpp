#pragma once

#include <Eigen/Core>

#include "filter/judge/run/evaluate.hpp"
#include "filter/judge/score/statistics.hpp"

namespace modebank {

struct Interval {
  double lower, upper;
};

/// Squared distances of single samples over what a filter states: NIS of the signals that are there, NEES of the states
/// that are judged. That of a sample with d of them has mean d in a true filter, and the chi-square law of d degrees of
/// freedom where the prediction is one Gaussian of known variance.
struct SquaredDistances {
  SeriesByRun value;
  SeriesByRun degrees;  ///< d of each

  void begin_run();
  /// `d`: nothing is added where it is 0.
  void add(double distance, Eigen::Index d);
};

/// How many signals of a sample are scored.
Eigen::Index scored_signals(const RunEvaluation& evaluation, Eigen::Index sample);

/// The one mean: sum of distances over sum of degrees, times `of_all`, the degrees of a sample that misses none, which
/// is a true filter's mean whatever is missing. A sample counts by its degrees. NaN without samples.
double mean_distance(const SquaredDistances& distances, double of_all);

/// Variance of the distances about their share of the mean over that of chi-square terms of the same mean and degrees:
/// 1 for a true filter whose predictions are single Gaussians, more where rare terms are large, as with modes that are
/// seldom and far. A factor on the distances leaves it. 1 without values or variance.
double dispersion(const SquaredDistances& distances);

/// Where mean_distance lies in a true filter with probability `level`: a chi-square law of the sum's degrees divided by
/// the autocorrelation time of the distances about their share of the mean, with its margin (cautious_time), and, where
/// a single distance is not `chi_square`, by their dispersion (matching of moments: Satterthwaite 1946, Biometrics
/// Bulletin 2). NaN without samples.
Interval mean_distance_interval(const SquaredDistances& distances, double of_all, bool chi_square, double level = 0.95);

/// NIS of every sample on the scale of all signals, so that one region holds them all: where signals are missing, what
/// a NIS of all would be that a true filter exceeds as often. N; NaN where nothing was measured.
Eigen::VectorXd nis_of_all_signals(const RunEvaluation& evaluation);

}  // namespace modebank
