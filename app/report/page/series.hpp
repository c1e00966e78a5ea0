#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "app/report/page/page_arrays.hpp"

namespace modebank::app::report {

/// Value of a bucket of samples in drawings; shares have their mean, so that they continue to sum to one.
enum class Bucket { extremes, lowest, highest, share };

/// One signal over a run's samples for time plots: the samples (if `finest` is 1), and buckets that grow by 16 from
/// level to level, so that the page never handles more values than it can show. {"raw": array or null, "levels":
/// [{"bucket", "low"?, "high"?}]}. Edges of a band (lowest, highest) have no raw array; there the page adds the half
/// width to the center.
nlohmann::json series(PageArrays& arrays, const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index finest,
                      Bucket bucket = Bucket::extremes);

/// Largest possible size of series() and time_axis() for this many samples, without compression [bytes].
std::size_t most_series_bytes(Eigen::Index samples, Eigen::Index finest, Bucket bucket = Bucket::extremes);
std::size_t most_time_bytes(const Eigen::VectorXd& time_s, Eigen::Index finest);

/// The run's times: {"start", "period"} for a regular clock, else {"raw", "levels"} of exact times (a bucket has the
/// time of its first sample). Both have "samples", "end" and "finest".
nlohmann::json time_axis(PageArrays& arrays, const Eigen::VectorXd& time_s, Eigen::Index finest);

}  // namespace modebank::app::report
