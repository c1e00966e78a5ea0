#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "app/report/page/page_arrays.hpp"

namespace modebank::app::report {

/// The value that a drawing shows for a bucket of samples. It shows extremes, but for shares the mean, because means
/// still sum to one.
enum class Bucket { extremes, lowest, highest, share };

/// One signal over a run's samples for time plots: {"raw": array or null, "levels": [{"bucket", "low"?, "high"?}]}.
/// - `raw` contains the samples if `finest` is 1.
/// - The buckets of each level are 16 times larger than those of the level before. So the page reads about as many
///   values as it shows.
/// - The edges of a band (lowest, highest) have no raw array. The page adds the half width to the center.
nlohmann::json series(PageArrays& arrays, const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index finest,
                      Bucket bucket = Bucket::extremes);

/// Largest possible size of series() or time_axis() for this number of samples, without compression [bytes].
std::size_t most_series_bytes(Eigen::Index samples, Eigen::Index finest, Bucket bucket = Bucket::extremes);
std::size_t most_time_bytes(const Eigen::VectorXd& time_s, Eigen::Index finest);

/// The times of a run: {"start", "period"} for a regular clock, else {"raw", "levels"} with exact times. A bucket has
/// the time of its first sample. Both forms also have "samples", "end" and "finest".
nlohmann::json time_axis(PageArrays& arrays, const Eigen::VectorXd& time_s, Eigen::Index finest);

}  // namespace modebank::app::report
