// Sums of outer products, computed block by block in register tiles.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ident/fit/gram.cpp"
#include "ident/fit/gram.hpp"

#include <hwy/aligned_allocator.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace modebank::gram::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

inline constexpr std::ptrdiff_t tile = 4;

/// Adds the outer products of `count` rows of `block` to the lower tiles of `sums` (side x side, column-major). Columns
/// of `block` lie `stride` apart and are zero-padded to a multiple of the vector length.
void add_block(const double* block, std::ptrdiff_t stride, std::ptrdiff_t count, std::ptrdiff_t side, double* sums) {
  const D d;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  for (std::ptrdiff_t c = 0; c < side; c += tile)
    for (std::ptrdiff_t r = c; r < side; r += tile) {
      V sum[tile][tile];
      for (auto& row : sum)
        for (V& v : row) v = hn::Zero(d);
      for (std::ptrdiff_t k = 0; k < count; k += lanes) {
        V b[tile];
        for (std::ptrdiff_t j = 0; j < tile; ++j) b[j] = hn::Load(d, block + (c + j) * stride + k);
        for (std::ptrdiff_t i = 0; i < tile; ++i) {
          const V a = hn::Load(d, block + (r + i) * stride + k);
          for (std::ptrdiff_t j = 0; j < tile; ++j) sum[i][j] = hn::MulAdd(a, b[j], sum[i][j]);
        }
      }
      for (std::ptrdiff_t i = 0; i < tile; ++i)
        for (std::ptrdiff_t j = 0; j < tile; ++j)
          sums[(c + j) * side + r + i] += hn::GetLane(hn::SumOfLanes(d, sum[i][j]));
    }
}

}  // namespace modebank::gram::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modebank {
namespace gram {

HWY_EXPORT(add_block);

/// Calls `add_block` for this processor. Highway requires the unqualified name if a function is built for one processor
/// only.
void dispatch(const double* block, std::ptrdiff_t stride, std::ptrdiff_t count, std::ptrdiff_t side, double* sums) {
  HWY_DYNAMIC_DISPATCH(add_block)(block, stride, count, side, sums);
}

}  // namespace gram

Eigen::MatrixXd weighted_gram(const Eigen::MatrixXd& left, const Eigen::MatrixXd& right,
                              const std::vector<Eigen::Index>& rows, const Eigen::VectorXd& root) {
  using Eigen::Index;
  // 20 columns of a block of this size fit into the first-level cache
  constexpr Index block_rows = 256, tile = gram::HWY_NAMESPACE::tile;
  const Index q = left.cols(), columns = q + right.cols();
  const Index side = (columns + tile - 1) / tile * tile;
  const auto block = hwy::AllocateAligned<double>(static_cast<std::size_t>(side * block_rows));
  std::fill_n(block.get(), side * block_rows, 0.0);
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(side, side);
  for (Index first = 0; first < std::ssize(rows); first += block_rows) {
    const Index count = std::min(block_rows, std::ssize(rows) - first);
    for (Index c = 0; c < columns; ++c) {
      const double* from = c < q ? left.col(c).data() : right.col(c - q).data();
      double* to = block.get() + c * block_rows;
      for (Index k = 0; k < count; ++k) to[k] = root(first + k) * from[rows[static_cast<std::size_t>(first + k)]];
      std::fill(to + count, to + block_rows, 0.0);
    }
    gram::dispatch(block.get(), block_rows, count, side, sums.data());
  }
  sums.triangularView<Eigen::StrictlyUpper>() = sums.transpose();
  return sums.topLeftCorner(columns, columns);
}

}  // namespace modebank
#endif
