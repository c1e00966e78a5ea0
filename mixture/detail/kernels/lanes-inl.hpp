// Vector types, and the normalisation of a block's log densities. Included once per instruction set (Highway's
// foreach_target.h).
#if defined(MODEBANK_EM_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_EM_LANES_INL
#undef MODEBANK_EM_LANES_INL
#else
#define MODEBANK_EM_LANES_INL
#endif

#include "ident/base/detail/exp-inl.hpp"
#include "mixture/detail/kernels/kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::em::HWY_NAMESPACE {

using batch::HWY_NAMESPACE::reciprocal;

inline constexpr Index L = hn::MaxLanes(D());
static_assert(block_size % (2 * L) == 0 && L <= most_lanes);

HWY_INLINE V zero() { return hn::Zero(D()); }
HWY_INLINE V load(const double* from) { return hn::Load(D(), from); }
HWY_INLINE void store(V value, double* to) { hn::Store(value, D(), to); }
HWY_INLINE void add_to(double* sum, V value) { store(hn::Add(load(sum), value), sum); }

/// Upper limit of squared distances, so that no density is NaN. It replaces squares that overflow. It also replaces
/// NaN, which results if parts of a distance overflow with different signs.
inline constexpr double largest_distance = 2e300;

HWY_INLINE V bounded(V distance) {
  const V largest = splat(largest_distance);
  return hn::IfThenElse(hn::Lt(distance, largest), distance, largest);
}

/// Normalises log densities. On entry scratch.relative has the log densities of `rows` components, and
/// scratch.log_density the largest log density of each point. On return `relative` has the densities divided by the
/// largest one, and log_density the log density of the mixture.
HWY_INLINE void normalise(int rows, const Scratch& scratch) {
  const Exp exp;
  const Log log;
  for (int k = 0; k < rows; ++k) {
    double* relative = scratch.relative + k * block_size;
    for (Index n = 0; n < block_size; n += 2 * L) {
      const V a = exp(hn::Sub(load(relative + n), load(scratch.log_density + n)));
      const V b = exp(hn::Sub(load(relative + n + L), load(scratch.log_density + n + L)));
      store(a, relative + n);
      store(b, relative + n + L);
      store(k == 0 ? a : hn::Add(load(scratch.sum + n), a), scratch.sum + n);
      store(k == 0 ? b : hn::Add(load(scratch.sum + n + L), b), scratch.sum + n + L);
    }
  }
  for (Index n = 0; n < block_size; n += L) add_to(scratch.log_density + n, log(load(scratch.sum + n)));
}

/// Adds the row of the noise component, which follows the rows of the Gaussians.
HWY_INLINE int add_noise(const Components& components, const Block& block, const Scratch& scratch) {
  if (!block.noise) return components.count;
  double* row = scratch.relative + components.count * block_size;
  for (Index n = 0; n < block_size; n += L) {
    const V noise = load(block.noise + n);
    store(noise, row + n);
    store(hn::Max(load(scratch.log_density + n), noise), scratch.log_density + n);
  }
  return components.count + 1;
}

/// An upper bound of all log densities in a block, so that one shift is valid for the whole block.
HWY_INLINE double largest_log_constant(const Components& components) {
  double largest = components.log_constants[0];
  for (int k = 1; k < components.count; ++k)
    largest = components.log_constants[k] > largest ? components.log_constants[k] : largest;
  return largest;
}

/// Completes densities relative to exp(shift): adds the noise component and converts the sums into log densities.
/// Returns false if one shift for all points is impossible, because a point is too far from all components or the noise
/// density is too large.
HWY_INLINE bool finish_shifted(const Components& components, const Block& block, double shift, const Scratch& scratch) {
  const V least = splat(1e-150), most = splat(1e150), by = splat(shift);
  const Exp exp;
  const Log log;
  auto sound = hn::Eq(by, by);
  for (Index n = 0; n < block_size; n += L) {
    V sum = load(scratch.sum + n);
    if (block.noise) {
      const V noise = exp(hn::Sub(load(block.noise + n), by));
      store(noise, scratch.relative + components.count * block_size + n);
      sum = hn::Add(sum, noise);
      store(sum, scratch.sum + n);
    }
    sound = hn::And(sound, hn::And(hn::Ge(sum, least), hn::Le(sum, most)));
    store(hn::Add(by, log(sum)), scratch.log_density + n);
  }
  return hn::AllTrue(D(), sound);
}

/// Adds the log-likelihood and the noise of a block to the first two lane sums. Leaves weight / sum in scratch.sum.
HWY_INLINE void begin_sums(const Components& components, const Block& block, const Scratch& scratch) {
  V likelihood = load(scratch.lanes), noise = load(scratch.lanes + L);
  const double* row = scratch.relative + components.count * block_size;
  for (Index n = 0; n < block_size; n += L) {
    const V weight = load(block.weights + n);
    likelihood = hn::MulAdd(weight, load(scratch.log_density + n), likelihood);
    const V scale = hn::Mul(weight, reciprocal(load(scratch.sum + n)));
    store(scale, scratch.sum + n);
    if (block.noise) noise = hn::MulAdd(scale, load(row + n), noise);
  }
  store(likelihood, scratch.lanes);
  store(noise, scratch.lanes + L);
}

template <class Kernel>
void measure(const Components& components, const Block& block, const Scratch& scratch) {
  Kernel::evaluate(components, block, scratch);
  begin_sums(components, block, scratch);
}

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
