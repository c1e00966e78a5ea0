#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mixture/kmeans_kernels.cpp"
#include "mixture/kmeans_kernels.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "mixture/em_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::em::HWY_NAMESPACE {

/// Vectors of points whose distances are computed at a time.
inline constexpr int together = 4;
static_assert(block_size % (together * L) == 0);

HWY_INLINE V limited(V distance) {
  const V largest = splat(1e200);
  return hn::IfThenElse(hn::Lt(distance, largest), distance, largest);
}

HWY_INLINE void squared_distances(const Block& block, int features, const double* center, Index n,
                                  V (&distance)[together]) {
  for (int v = 0; v < together; ++v) distance[v] = zero();
  for (int f = 0; f < features; ++f) {
    const V c = splat(center[f]);
    const double* column = block.points + f * block_size + n;
    for (int v = 0; v < together; ++v) {
      const V d = hn::Sub(load(column + v * L), c);
      distance[v] = hn::MulAdd(d, d, distance[v]);
    }
  }
  for (int v = 0; v < together; ++v) distance[v] = limited(distance[v]);
}

double closer_in_block(const Block& block, int features, const double* center, const double* nearest, double* out) {
  V sum = zero(), distance[together];
  for (Index n = 0; n < block_size; n += together * L) {
    squared_distances(block, features, center, n, distance);
    for (int v = 0; v < together; ++v) {
      const V least = hn::Min(distance[v], load(nearest + n + v * L));
      store(least, out + n + v * L);
      sum = hn::MulAdd(load(block.weights + n + v * L), least, sum);
    }
  }
  return hn::GetLane(hn::SumOfLanes(D(), sum));
}

void nearest_in_block(const Block& block, int features, const double* centers, int count, int* labels) {
  const hn::Rebind<std::int32_t, D> integers;
  V distance[together], nearest[together], label[together];
  for (Index n = 0; n < block_size; n += together * L) {
    squared_distances(block, features, centers, n, nearest);
    for (int v = 0; v < together; ++v) label[v] = zero();
    for (int k = 1; k < count; ++k) {
      squared_distances(block, features, centers + k * features, n, distance);
      const V own = splat(static_cast<double>(k));
      for (int v = 0; v < together; ++v) {
        label[v] = hn::IfThenElse(hn::Lt(distance[v], nearest[v]), own, label[v]);
        nearest[v] = hn::Min(distance[v], nearest[v]);
      }
    }
    for (int v = 0; v < together; ++v) hn::StoreU(hn::DemoteTo(integers, label[v]), integers, labels + n + v * L);
  }
}

KmeansKernels kmeans() { return {closer_in_block, nearest_in_block}; }

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modebank::em {

HWY_EXPORT(kmeans);

KmeansKernels kmeans_kernels() { return HWY_DYNAMIC_DISPATCH(kmeans)(); }

}  // namespace modebank::em
#endif
