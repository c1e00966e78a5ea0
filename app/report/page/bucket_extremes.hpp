#pragma once

#include <Eigen/Core>

namespace modebank {

/// Smallest and largest value of every `bucket` consecutive values, so that a drawing shows every extreme of the
/// series. The last bucket may have fewer values. NaN is ignored; a bucket of only NaN gives NaN.
struct BucketExtremes {
  Eigen::VectorXd low, high;  ///< ceil(N / bucket)
};

/// Throws std::invalid_argument unless bucket >= 1.
BucketExtremes bucket_extremes(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index bucket);

/// Means of the buckets, for shares, which must continue to sum to one.
Eigen::VectorXd bucket_means(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index bucket);

}  // namespace modebank
