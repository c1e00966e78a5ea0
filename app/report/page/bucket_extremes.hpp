#pragma once

#include <Eigen/Core>

namespace modebank {

/// Smallest and largest value of every `bucket` consecutive ones (the last bucket may have fewer): a drawing of them
/// shows every extreme of the series. NaN entries are left out; a bucket of nothing else is NaN.
struct BucketExtremes {
  Eigen::VectorXd low, high;  ///< ceil(N / bucket)
};

/// Throws std::invalid_argument unless bucket >= 1.
BucketExtremes bucket_extremes(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index bucket);

/// Their means instead, for shares that shall go on adding up to one.
Eigen::VectorXd bucket_means(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index bucket);

}  // namespace modebank
