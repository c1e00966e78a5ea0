#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <optional>
#include <random>
#include <vector>

#include "mixture/detail/feature_scale.hpp"
#include "mixture/detail/kernels/kernels.hpp"
#include "mixture/em.hpp"
#include "mixture/point_set.hpp"

namespace modebank {

/// Doubles aligned to 64 bytes, the widest vector. Initialised to zero unless created by `unset`.
class AlignedBuffer {
 public:
  AlignedBuffer() = default;
  explicit AlignedBuffer(std::ptrdiff_t size) : AlignedBuffer(unset(size)) { std::fill_n(data_.get(), size, 0.0); }
  static AlignedBuffer unset(std::ptrdiff_t size) {
    AlignedBuffer result;
    result.data_.reset(
        static_cast<double*>(::operator new(static_cast<std::size_t>(size) * sizeof(double), alignment)));
    return result;
  }
  double* data() { return data_.get(); }
  const double* data() const { return data_.get(); }

 private:
  static constexpr std::align_val_t alignment{64};
  struct Delete {
    void operator()(double* data) const { ::operator delete(data, alignment); }
  };
  std::unique_ptr<double, Delete> data_;
};

/// A copy of some points with their weights, errors and runs.
struct PointPart {
  Eigen::MatrixXd points;
  Eigen::VectorXd weights;
  Eigen::MatrixXd covariances;
  Eigen::VectorXd typical_error;

  PointPart(const PointSet& all, const std::vector<Eigen::Index>& positions)
      : points(all.points(Eigen::all, positions)), typical_error(all.typical_error) {
    if (all.weights.size() > 0) weights = all.weights(positions);
    if (all.has_errors()) covariances = all.covariances(Eigen::all, positions);
  }
  PointSet set() const { return PointSet(points, weights, covariances, typical_error); }
};

using BlockColumn = Eigen::Array<double, block_size, 1>;
using BlockColumns = Eigen::Array<double, block_size, Eigen::Dynamic>;

/// Weighted points in scaled units, in blocks of fixed length. Within a block each feature is one column (structure of
/// arrays), so that every loop over points is vectorised. The last block is padded with points of weight zero. Small
/// clouds are copied. Large clouds are laid out block by block on each reading, which saves the memory of a copy. The
/// results are the same to the last bit. The object holds a reference to its original points, but an object made by
/// for_starts does not.
class PointBlocks {
 public:
  /// Only clouds of at most `most_copied` bytes are copied.
  PointBlocks(const PointSet& set, const FeatureScale& scale, std::ptrdiff_t most_copied = std::ptrdiff_t{32} << 20);

  Eigen::Index features() const { return features_; }
  Eigen::Index count() const { return count_; }  ///< N, number of points without padding
  Eigen::Index blocks() const { return (count_ + block_size - 1) / block_size; }
  double total_weight() const { return total_weight_; }
  bool has_errors() const { return has_errors_; }
  /// Number of points in `block` without padding.
  Eigen::Index points_in(Eigen::Index block) const { return std::min(block_size, count_ - block * block_size); }

  /// Memory in which a block of a cloud is laid out if the cloud is not copied.
  AlignedBuffer stage() const { return AlignedBuffer::unset(copied_ ? 0 : block_doubles()); }
  em::Block block(Eigen::Index block, AlignedBuffer& stage) const;

  /// A copy of at most `most` points, from which a start is chosen. If there are more points, the copy holds evenly
  /// spread ones that begin at a random point. A weight w becomes w / (1 + mean of S_ff over the features), so points
  /// with large error variances count less. The copy has no reference to the original points, so calling this function
  /// on a copy throws std::logic_error.
  PointBlocks for_starts(Eigen::Index most, std::mt19937_64& generator) const;

  // The functions below are valid only for copied clouds.

  /// block_size x F.
  Eigen::Map<const BlockColumns> points(Eigen::Index block) const { return {data(block), block_size, features_}; }
  Eigen::Map<const BlockColumn> weights(Eigen::Index block) const {
    return Eigen::Map<const BlockColumn>(data(block) + features_ * block_size);
  }

 private:
  Eigen::Index error_columns() const { return has_errors() ? features_ * (features_ + 1) / 2 : 0; }
  /// Number of doubles per block, for points, weights and errors.
  Eigen::Index block_doubles() const { return (features_ + 1 + error_columns()) * block_size; }
  const double* data(Eigen::Index block) const;
  void lay_out(Eigen::Index block, double* to) const;

  std::optional<PointSet> set_;  ///< empty once the original points have been released
  FeatureScale scale_;
  Eigen::Index features_;
  Eigen::Index count_;
  bool has_errors_;
  bool copied_;
  AlignedBuffer blocks_;
  double total_weight_ = 0.0;
};

/// The cloud in the units of the fit.
struct ScaledCloud {
  FeatureScale scale;
  PointBlocks points;
  UniformNoise noise;  ///< noise component in physical units; absent if it was not requested

  ScaledCloud(const PointSet& set, const EmOptions& options)
      : scale(FeatureScale::of(set, options.covariance_floor)), points(set, scale) {
    if (!options.noise_component) return;
    noise = bounding_box(set, scale, options.covariance_floor);
    constexpr double noise_start = 0.05;
    noise.weight = noise_start;
  }

  /// Sets the noise component of a mixture in scaled units: the requested component, or none.
  void set_noise(GaussianMixture& scaled) const {
    const double kept = scaled.noise.weight > 0.0 ? scaled.noise.weight : noise.weight;
    GaussianMixture box = scaled;
    box.noise = noise;
    scaled.noise = scale.to_scaled(box).noise;
    if (noise.present()) scaled.noise.weight = kept;
    scaled.weights *= (1.0 - (noise.present() ? kept : 0.0)) / scaled.weights.sum();
  }
};

}  // namespace modebank
