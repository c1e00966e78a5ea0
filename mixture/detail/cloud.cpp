#include "mixture/detail/cloud.hpp"

#include <boost/random/uniform_01.hpp>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace modebank {

using Eigen::Index;

namespace {

/// Upper limit of the standard deviation of an error (scaled units). A point with a larger error carries no
/// information.
constexpr double largest_error = 1e15;

}  // namespace

PointBlocks::PointBlocks(const PointSet& set, const FeatureScale& scale, std::ptrdiff_t most_copied)
    : set_(set), scale_(scale), features_(set.features()), count_(set.count()), has_errors_(set.has_errors()) {
  const std::ptrdiff_t bytes = blocks() * block_doubles() * static_cast<std::ptrdiff_t>(sizeof(double));
  copied_ = bytes <= most_copied;
  if (copied_) blocks_ = AlignedBuffer::unset(blocks() * block_doubles());
  for (Index b = 0; b < blocks(); ++b) {
    if (copied_) lay_out(b, blocks_.data() + b * block_doubles());
    const Index first = b * block_size;
    total_weight_ +=
        set.weights.size() > 0 ? set.weights.segment(first, points_in(b)).sum() : static_cast<double>(points_in(b));
  }
}

const double* PointBlocks::data(Index block) const {
  assert(copied_);
  return blocks_.data() + block * block_doubles();
}

em::Block PointBlocks::block(Index block, AlignedBuffer& stage) const {
  if (!copied_) lay_out(block, stage.data());
  const double* const from = copied_ ? data(block) : stage.data();
  em::Block result;
  result.points = from;
  result.weights = from + features_ * block_size;
  if (has_errors()) result.errors = result.weights + block_size;
  return result;
}

void PointBlocks::lay_out(Index block, double* to) const {
  const Index first = block * block_size, filled = points_in(block);
  double* const weights = to + features_ * block_size;
  const PointSet& set = *set_;
  const bool weighted = set.weights.size() > 0;
  if (weighted)
    std::copy_n(set.weights.data() + first, filled, weights);
  else
    std::fill_n(weights, filled, 1.0);
  std::fill(weights + filled, weights + block_size, 0.0);
  const double* const from = set.points.data() + first * features_;
  for (Index f = 0; f < features_; ++f) {
    double* const column = to + f * block_size;
    const double center = scale_.center(f), inverse = scale_.inverse(f);
    for (Index i = 0; i < filled; ++i) column[i] = (from[i * features_ + f] - center) * inverse;
    // A point of weight zero may lie anywhere, even where its square overflows.
    for (Index i = 0; weighted && i < filled; ++i)
      if (!(weights[i] > 0.0)) column[i] = 0.0;
    std::fill(column + filled, column + block_size, 0.0);
  }
  if (!has_errors()) return;
  double* column = weights + block_size;
  Eigen::VectorXd unit(features_);
  std::fill(column, column + error_columns() * block_size, 0.0);
  for (Index i = 0; i < filled; ++i) {
    const double* const S = set.covariances.col(first + i).data();
    for (Index f = 0; f < features_; ++f) {
      const double sd = std::sqrt(S[f * features_ + f]) / scale_.scale(f);
      unit(f) = (sd > largest_error ? largest_error / sd : 1.0) / scale_.scale(f);
    }
    for (Index f = 0, entry = 0; f < features_; ++f)
      for (Index g = 0; g <= f; ++g, ++entry) column[entry * block_size + i] = S[f * features_ + g] * unit(f) * unit(g);
  }
}

PointBlocks PointBlocks::for_starts(Index most, std::mt19937_64& generator) const {
  if (!set_) throw std::logic_error("starts need the original points, which this copy no longer has");
  const PointSet& set = *set_;
  const Index chosen = std::min(most, count_);
  const double stride = static_cast<double>(count_) / static_cast<double>(chosen);
  const double first = chosen < count_ ? boost::random::uniform_01<double>()(generator) : 0.0;
  Eigen::MatrixXd points(features_, chosen);
  Eigen::VectorXd weights(chosen);
  for (Index i = 0; i < chosen; ++i) {
    const Index from = std::min(static_cast<Index>((static_cast<double>(i) + first) * stride), count_ - 1);
    points.col(i) = set.points.col(from);
    weights(i) = set.weights.size() > 0 ? set.weights(from) : 1.0;
    if (!has_errors_) continue;
    const Eigen::Map<const Eigen::MatrixXd> S(set.covariances.col(from).data(), features_, features_);
    const double relative = (S.diagonal().array() / scale_.scale.array().square()).mean();
    weights(i) /= 1.0 + std::min(relative, largest_error);
  }
  PointBlocks result(PointSet(points, weights), scale_, std::numeric_limits<std::ptrdiff_t>::max());
  result.set_.reset();
  return result;
}

}  // namespace modebank
