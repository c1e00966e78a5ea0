#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "app/report/page/page_arrays.hpp"

namespace modebank::app::report {

/// What a bucket of samples is drawn by; shares by their mean, so that they go on adding up to one.
enum class Bucket { extremes, lowest, highest, share };

/// One signal over a run's samples for the page's time plots: sample by sample where `finest` is 1, and by ever larger
/// buckets (16 times as large from level to level), so that the page never handles more than it can show.
/// {"raw": array or null, "levels": [{"bucket", "low"?, "high"?}]}. The edges of a band (lowest, highest) have no raw
/// form: there the page adds the half width to the center.
nlohmann::json series(PageArrays& arrays, const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index finest,
                      Bucket bucket = Bucket::extremes);

/// Bytes that series() and time_axis() of so many samples take in a page at most: what does not compress.
std::size_t most_series_bytes(Eigen::Index samples, Eigen::Index finest, Bucket bucket = Bucket::extremes);
std::size_t most_time_bytes(const Eigen::VectorXd& time_s, Eigen::Index finest);

/// The run's times: {"start", "period"} of a regular clock, else {"raw", "levels"} of exact times (a bucket's is that
/// of its first sample); both with "samples", "end" and "finest".
nlohmann::json time_axis(PageArrays& arrays, const Eigen::VectorXd& time_s, Eigen::Index finest);

}  // namespace modebank::app::report
