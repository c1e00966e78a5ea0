#pragma once

#include <Eigen/Core>

namespace modebank {

/// Smallest and largest value in each group of `bucket` consecutive values. A drawing of them shows every extreme of
/// the series. The last bucket may have fewer values. NaN is ignored, unless a bucket contains only NaN.
struct BucketExtremes {
  Eigen::VectorXd low, high;  ///< ceil(N / bucket) values each
};

/// Throws std::invalid_argument unless bucket >= 1.
BucketExtremes bucket_extremes(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index bucket);

/// Mean of each bucket. Shares need means, because means still sum to one.
Eigen::VectorXd bucket_means(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index bucket);

}  // namespace modebank
