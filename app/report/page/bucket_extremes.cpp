#include "app/report/page/bucket_extremes.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

/// Calls visit(i, first, count) for each bucket.
template <class Visit>
Eigen::Index visit_buckets(Eigen::Index values, Eigen::Index bucket, Visit visit) {
  if (bucket < 1) throw std::invalid_argument("a bucket holds at least one value");
  Eigen::Index i = 0;
  for (Eigen::Index first = 0; first < values; first += bucket, ++i) visit(i, first, std::min(bucket, values - first));
  return i;
}

}  // namespace

BucketExtremes bucket_extremes(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index bucket) {
  const Eigen::Index buckets = visit_buckets(values.size(), bucket, [](auto, auto, auto) {});
  BucketExtremes result{Eigen::VectorXd::Constant(buckets, not_a_number),
                        Eigen::VectorXd::Constant(buckets, not_a_number)};
  visit_buckets(values.size(), bucket, [&](Eigen::Index i, Eigen::Index first, Eigen::Index count) {
    double &low = result.low(i), &high = result.high(i);
    for (const double value : values.segment(first, count)) {
      low = std::fmin(low, value);  // fmin and fmax ignore a NaN
      high = std::fmax(high, value);
    }
  });
  return result;
}

Eigen::VectorXd bucket_means(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index bucket) {
  const Eigen::Index buckets = visit_buckets(values.size(), bucket, [](auto, auto, auto) {});
  Eigen::VectorXd means(buckets);
  visit_buckets(values.size(), bucket, [&](Eigen::Index i, Eigen::Index first, Eigen::Index count) {
    double sum = 0.0;
    Eigen::Index known = 0;
    for (const double value : values.segment(first, count))
      if (!std::isnan(value)) {
        sum += value;
        ++known;
      }
    means(i) = known > 0 ? sum / static_cast<double>(known) : not_a_number;
  });
  return means;
}

}  // namespace modebank
