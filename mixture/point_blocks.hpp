#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace modebank {

/// Points per block: long enough to hide call overhead, short enough that a block of 12 components stays in L1.
inline constexpr Eigen::Index block_size = 128;
using BlockColumn = Eigen::Array<double, block_size, 1>;
using BlockColumns = Eigen::Array<double, block_size, Eigen::Dynamic>;

/// Weighted points in blocks of fixed length, one column per feature within a block (structure of arrays), so that
/// every loop over points is vectorised. The last block is filled up with points of weight zero.
class PointBlocks {
 public:
  /// `points` F x N; `weights` N, or empty for all one.
  PointBlocks(const Eigen::MatrixXd& points, const Eigen::VectorXd& weights);

  Eigen::Index features() const { return features_; }
  Eigen::Index count() const { return count_; }  ///< N, without the filling
  Eigen::Index blocks() const { return weights_.cols(); }
  double total_weight() const { return total_weight_; }
  /// block_size x F.
  auto points(Eigen::Index block) const { return points_.middleCols(block * features_, features_); }
  auto weights(Eigen::Index block) const { return weights_.col(block); }
  /// Number of points of `block` that are not filling.
  Eigen::Index points_in(Eigen::Index block) const { return std::min(block_size, count_ - block * block_size); }
  double weight(Eigen::Index point) const { return weights_(point % block_size, point / block_size); }
  double coordinate(Eigen::Index point, Eigen::Index feature) const {
    return points_(point % block_size, (point / block_size) * features_ + feature);
  }

 private:
  Eigen::Index features_;
  Eigen::Index count_;
  BlockColumns points_;
  BlockColumns weights_;
  double total_weight_;
};

}  // namespace modebank
