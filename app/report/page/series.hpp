#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "app/report/page/page_arrays.hpp"

namespace modebank::app::report {

/// Value of a bucket of samples in drawings: extremes, but the mean for shares, which must continue to sum to one.
enum class Bucket { extremes, lowest, highest, share };

/// One signal over a run's samples for time plots: {"raw": array or null, "levels": [{"bucket", "low"?, "high"?}]}.
/// `raw` contains the samples if `finest` is 1. The buckets of each level are 16 times larger than those of the level
/// before, so that the page reads about as many values as it shows. A band's edges (lowest, highest) have no raw array;
/// the page adds the half width to the center.
nlohmann::json series(PageArrays& arrays, const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index finest,
                      Bucket bucket = Bucket::extremes);

/// Largest possible size of series() and time_axis() for this number of samples, without compression [bytes].
std::size_t most_series_bytes(Eigen::Index samples, Eigen::Index finest, Bucket bucket = Bucket::extremes);
std::size_t most_time_bytes(const Eigen::VectorXd& time_s, Eigen::Index finest);

/// The run's times: {"start", "period"} for a regular clock, else {"raw", "levels"} with exact times. The time of a
/// bucket is that of its first sample. Both forms also have "samples", "end" and "finest".
nlohmann::json time_axis(PageArrays& arrays, const Eigen::VectorXd& time_s, Eigen::Index finest);

}  // namespace modebank::app::report
