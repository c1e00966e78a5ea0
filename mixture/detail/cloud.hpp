#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <random>

#include "mixture/aligned_buffer.hpp"
#include "mixture/em_kernels.hpp"
#include "mixture/feature_scale.hpp"
#include "mixture/point_set.hpp"

namespace modebank {

using BlockColumn = Eigen::Array<double, block_size, 1>;
using BlockColumns = Eigen::Array<double, block_size, Eigen::Dynamic>;

/// Weighted points in scaled units in blocks of fixed length, one column per feature within a block (structure of
/// arrays), so that every loop over points is vectorised. The last block is filled up with points of weight zero. Small
/// clouds are copied; large ones are laid out block by block whenever they are read, so that they need no second copy
/// in memory, and are the same to the last bit. Refers to the points it is made of.
class PointBlocks {
 public:
  /// Clouds of more than `most_copied` bytes are not copied.
  PointBlocks(const PointSet& set, const FeatureScale& scale, std::ptrdiff_t most_copied = std::ptrdiff_t{32} << 20);

  Eigen::Index features() const { return features_; }
  Eigen::Index count() const { return count_; }  ///< N, without the filling
  Eigen::Index blocks() const { return (count_ + block_size - 1) / block_size; }
  double total_weight() const { return total_weight_; }
  bool has_errors() const { return has_errors_; }
  /// Number of points of `block` that are not filling.
  Eigen::Index points_in(Eigen::Index block) const { return std::min(block_size, count_ - block * block_size); }

  /// Memory that a block is laid out in where the cloud is not copied.
  AlignedBuffer stage() const { return AlignedBuffer::unset(copied_ ? 0 : block_doubles()); }
  em::Block block(Eigen::Index block, AlignedBuffer& stage) const;

  /// At most `most` points to choose a start from, copied: all, or evenly spread ones from a random first on; weights
  /// fall with the error variances: w / (1 + mean of S_ff over the features).
  PointBlocks for_starts(Eigen::Index most, std::mt19937_64& generator) const;

  // Of copied clouds only.
  /// block_size x F.
  Eigen::Map<const BlockColumns> points(Eigen::Index block) const { return {data(block), block_size, features_}; }
  Eigen::Map<const BlockColumn> weights(Eigen::Index block) const {
    return Eigen::Map<const BlockColumn>(data(block) + features_ * block_size);
  }
  double weight(Eigen::Index point) const { return weights(point / block_size)(point % block_size); }
  double coordinate(Eigen::Index point, Eigen::Index feature) const {
    return points(point / block_size)(point % block_size, feature);
  }

 private:
  Eigen::Index error_columns() const { return has_errors() ? features_ * (features_ + 1) / 2 : 0; }
  /// Points, weights, errors.
  Eigen::Index block_doubles() const { return (features_ + 1 + error_columns()) * block_size; }
  const double* data(Eigen::Index block) const;
  void lay_out(Eigen::Index block, double* to) const;

  PointSet set_;  ///< not looked at once copied
  FeatureScale scale_;
  Eigen::Index features_;
  Eigen::Index count_;
  bool has_errors_;
  bool copied_;
  AlignedBuffer blocks_;
  double total_weight_ = 0.0;
};

}  // namespace modebank
