#include "app/report/page/series.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/report/page/bucket_extremes.hpp"

namespace modebank::app::report {
namespace {

using Eigen::Index;
using nlohmann::json;

constexpr Index level_factor = 16;
/// smallest number of buckets in a stored level; the page computes coarser levels from the coarsest stored one
constexpr Index least_buckets = 500;

/// Bucket sizes of the levels that are coarser than the samples.
std::vector<Index> level_buckets(Index samples, Index finest) {
  std::vector<Index> buckets;
  Index bucket = finest == 1 ? level_factor : finest;
  for (; bucket == finest || samples / bucket >= least_buckets; bucket *= level_factor) buckets.push_back(bucket);
  return buckets;
}

json level(PageArrays& arrays, const Eigen::Ref<const Eigen::VectorXd>& values, Index size, Bucket kind) {
  json entry = {{"bucket", size}};
  if (kind == Bucket::share) {
    entry["low"] = arrays.add_shares(bucket_means(values, size));
    return entry;
  }
  const BucketExtremes extremes = bucket_extremes(values, size);
  if (kind != Bucket::highest) entry["low"] = arrays.add(extremes.low);
  if (kind != Bucket::lowest) entry["high"] = arrays.add(extremes.high);
  return entry;
}

Index buckets_of(Index samples, Index size) { return (samples + size - 1) / size; }

/// Mean difference between consecutive times.
double period_of(const Eigen::VectorXd& time_s) {
  const Index N = time_s.size();
  return N > 1 ? (time_s(N - 1) - time_s(0)) / static_cast<double>(N - 1) : 1.0;
}

/// Whether all times are those of a clock with this period. The tolerance is a ten-thousandth of a period.
bool regular(const Eigen::VectorXd& time_s, double period) {
  constexpr double slack = 1e-4;
  for (Index k = 0; k < time_s.size(); ++k)
    if (std::abs(time_s(k) - time_s(0) - period * static_cast<double>(k)) > slack * period) return false;
  return true;
}

}  // namespace

nlohmann::json series(PageArrays& arrays, const Eigen::Ref<const Eigen::VectorXd>& values, Index finest, Bucket kind) {
  json levels = json::array();
  for (const Index size : level_buckets(values.size(), finest)) levels.push_back(level(arrays, values, size, kind));
  const bool edge = kind == Bucket::lowest || kind == Bucket::highest;
  json raw;
  if (finest == 1 && !edge) raw = kind == Bucket::share ? arrays.add_shares(values) : arrays.add(values);
  return {{"raw", raw}, {"levels", levels}};
}

std::size_t most_series_bytes(Index samples, Index finest, Bucket kind) {
  const bool edge = kind == Bucket::lowest || kind == Bucket::highest;
  const std::size_t width = kind == Bucket::share ? sizeof(std::uint16_t) : sizeof(float);
  std::size_t bytes = finest == 1 && !edge ? PageArrays::most_bytes(samples, width) : 0;
  for (const Index size : level_buckets(samples, finest))
    bytes += (kind == Bucket::extremes ? 2 : 1) * PageArrays::most_bytes(buckets_of(samples, size), width);
  return bytes;
}

std::size_t most_time_bytes(const Eigen::VectorXd& time_s, Index finest) {
  if (regular(time_s, period_of(time_s))) return 0;
  std::size_t bytes = finest == 1 ? PageArrays::most_bytes(time_s.size(), sizeof(double)) : 0;
  for (const Index size : level_buckets(time_s.size(), finest))
    bytes += PageArrays::most_bytes(buckets_of(time_s.size(), size), sizeof(double));
  return bytes;
}

nlohmann::json time_axis(PageArrays& arrays, const Eigen::VectorXd& time_s, Index finest) {
  const Index N = time_s.size();
  json axis = {{"samples", N},
               {"finest", finest},
               {"start", N ? json(time_s(0)) : json()},
               {"end", N ? json(time_s(N - 1)) : json()}};
  const double period = period_of(time_s);
  if (regular(time_s, period)) {
    axis["period"] = period;
    return axis;
  }
  axis["raw"] = finest == 1 ? arrays.add_exact(time_s) : json();
  axis["levels"] = json::array();
  for (const Index size : level_buckets(N, finest)) {
    const Eigen::VectorXd first = time_s(Eigen::seq(0, N - 1, size));
    axis["levels"].push_back({{"bucket", size}, {"low", arrays.add_exact(first)}});
  }
  return axis;
}

}  // namespace modebank::app::report
