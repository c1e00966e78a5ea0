#include "mixture/point_blocks.hpp"

namespace modebank {

using Eigen::Index;

PointBlocks::PointBlocks(const Eigen::MatrixXd& points, const Eigen::VectorXd& weights)
    : features_(points.rows()), count_(points.cols()) {
  const Index blocks = (count_ + block_size - 1) / block_size;
  points_.setZero(block_size, blocks * features_);
  weights_.setZero(block_size, blocks);
  for (Index i = 0; i < count_; ++i) {
    const Index block = i / block_size, row = i % block_size;
    for (Index f = 0; f < features_; ++f) points_(row, block * features_ + f) = points(f, i);
    weights_(row, block) = weights.size() ? weights(i) : 1.0;
  }
  total_weight_ = weights_.sum();
}

}  // namespace modebank
