// EM on any number of features: matrix products in tiles of registers. Included once per instruction set.
#if defined(MODEBANK_EM_TILES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_EM_TILES_INL
#undef MODEBANK_EM_TILES_INL
#else
#define MODEBANK_EM_TILES_INL
#endif

#include "mixture/detail/kernels/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::em::HWY_NAMESPACE {

/// Rows of W per tile (Packing::tiles).
inline constexpr int tile = 4;
/// Rows per tile of second moments; the registers of AVX-512 suffice for four.
inline constexpr int moment_rows = L == 8 ? 4 : 2;

HWY_INLINE int padded(int features) { return (features + tile - 1) / tile * tile; }

/// x - mu_k of a block, padded with zero columns to a whole number of tiles.
HWY_INLINE void all_offsets(const Components& components, int k, const double* points, double* out) {
  const int F = components.features;
  for (int i = 0; i < F; ++i) {
    const V mean = splat(components.means[k * F + i]);
    for (Index n = 0; n < block_size; n += L)
      store(hn::Sub(load(points + i * block_size + n), mean), out + i * block_size + n);
  }
  for (Index n = F * block_size; n < padded(F) * block_size; n += L) store(zero(), out + n);
}

HWY_INLINE void put_log_density(int k, Index n, V distance, V constant, const Scratch& scratch) {
  const V density = hn::NegMulAdd(bounded(distance), splat(0.5), constant);
  store(density, scratch.relative + k * block_size + n);
  store(k == 0 ? density : hn::Max(load(scratch.log_density + n), density), scratch.log_density + n);
}

/// Computes four rows of W (x - mu), two vectors of points at a time.
HWY_INLINE void full_log_density(const Components& components, int k, const double* offsets, const Scratch& scratch) {
  const int F = components.features;
  const V constant = splat(components.log_constants[k]);
  for (Index n = 0; n < block_size; n += 2 * L) {
    V distance[2] = {zero(), zero()};
    const double* W = components.whitening + k * components.stride;
    for (int row = 0; row < F; row += tile) {
      V a[tile], b[tile];
      for (int i = 0; i < tile; ++i) a[i] = b[i] = zero();
      const int columns = row + tile < F ? row + tile : F;
      for (int j = 0; j < columns; ++j, W += tile) {
        const V x = load(offsets + j * block_size + n), y = load(offsets + j * block_size + n + L);
        for (int i = 0; i < tile; ++i) {
          const V w = splat(W[i]);
          a[i] = hn::MulAdd(w, x, a[i]);
          b[i] = hn::MulAdd(w, y, b[i]);
        }
      }
      for (int i = 0; i < tile; ++i) {
        distance[0] = hn::MulAdd(a[i], a[i], distance[0]);
        distance[1] = hn::MulAdd(b[i], b[i], distance[1]);
      }
    }
    put_log_density(k, n, distance[0], constant, scratch);
    put_log_density(k, n + L, distance[1], constant, scratch);
  }
}

HWY_INLINE void diagonal_log_density(const Components& components, int k, const double* points,
                                     const Scratch& scratch) {
  const int F = components.features;
  const double *mean = components.means + k * F, *W = components.whitening + k * components.stride;
  const V constant = splat(components.log_constants[k]);
  for (Index n = 0; n < block_size; n += 4 * L) {
    V distance[4] = {zero(), zero(), zero(), zero()};
    for (int i = 0; i < F; ++i) {
      const V mu = splat(mean[i]), w = splat(W[i]);
      for (int v = 0; v < 4; ++v) {
        const V y = hn::Mul(w, hn::Sub(load(points + i * block_size + n + v * L), mu));
        distance[v] = hn::MulAdd(y, y, distance[v]);
      }
    }
    for (int v = 0; v < 4; ++v) put_log_density(k, n + v * L, distance[v], constant, scratch);
  }
}

/// Adds one tile of the sum r d d'; `rows` holds r d of the tile's rows.
HWY_INLINE void add_moment_tile(int F, int row, int column, const double* rows, const double* offsets, double* lanes) {
  V sum[moment_rows][tile];
  for (int i = 0; i < moment_rows; ++i)
    for (int j = 0; j < tile; ++j) sum[i][j] = zero();
  for (Index n = 0; n < block_size; n += L) {
    V d[tile];
    for (int j = 0; j < tile; ++j) d[j] = load(offsets + (column + j) * block_size + n);
    for (int i = 0; i < moment_rows; ++i) {
      const V rd = load(rows + i * block_size + n);
      for (int j = 0; j < tile; ++j) sum[i][j] = hn::MulAdd(rd, d[j], sum[i][j]);
    }
  }
  double* seconds = lanes + (1 + F) * L;
  for (int i = 0; i < moment_rows; ++i)
    for (int j = 0; j < tile; ++j) {
      const int r = row + i, c = column + j;
      if (r < F && c <= r) add_to(seconds + (r * (r + 1) / 2 + c) * L, sum[i][j]);
    }
}

/// Adds second moments. `work` holds the offsets, then r, then r d of the rows of a tile.
HWY_INLINE void add_full_moments(int F, double* work, double* lanes) {
  const double *offsets = work, *r = work + padded(F) * block_size;
  double* rows = work + (padded(F) + 1) * block_size;
  for (int row = 0; row < F; row += moment_rows) {
    for (int i = 0; i < moment_rows; ++i) {
      V sum = zero();
      for (Index n = 0; n < block_size; n += L) {
        const V rd = hn::Mul(load(r + n), load(offsets + (row + i) * block_size + n));
        store(rd, rows + i * block_size + n);
        sum = hn::Add(sum, rd);
      }
      if (row + i < F) add_to(lanes + (1 + row + i) * L, sum);
    }
    for (int column = 0; column < row + moment_rows; column += tile)
      add_moment_tile(F, row, column, rows, offsets, lanes);
  }
}

HWY_INLINE void add_diagonal_moments(int F, const double* mean, const double* points, const double* r, double* lanes) {
  for (int i = 0; i < F; ++i) {
    const V mu = splat(mean[i]);
    V first[2] = {zero(), zero()}, second[2] = {zero(), zero()};
    for (Index n = 0; n < block_size; n += 2 * L)
      for (int v = 0; v < 2; ++v) {
        const V d = hn::Sub(load(points + i * block_size + n + v * L), mu), rd = hn::Mul(load(r + n + v * L), d);
        first[v] = hn::Add(first[v], rd);
        second[v] = hn::MulAdd(rd, d, second[v]);
      }
    add_to(lanes + (1 + i) * L, hn::Add(first[0], first[1]));
    add_to(lanes + (1 + F + i) * L, hn::Add(second[0], second[1]));
  }
}

template <bool diagonal>
struct Tiles {
  static Index work(int features) { return (padded(features) + 1 + moment_rows) * block_size; }

  static void evaluate(const Components& components, const Block& block, const Scratch& scratch) {
    for (int k = 0; k < components.count; ++k) {
      if constexpr (diagonal) {
        diagonal_log_density(components, k, block.points, scratch);
      } else {
        all_offsets(components, k, block.points, scratch.work);
        full_log_density(components, k, scratch.work, scratch);
      }
    }
    normalise(add_noise(components, block, scratch), scratch);
  }

  static void accumulate(const Components& components, const Block& block, const Scratch& scratch) {
    evaluate(components, block, scratch);
    begin_sums(components, block, scratch);
    const int F = components.features;
    const Index entries = 1 + F + (diagonal ? F : F * (F + 1) / 2);
    double *lanes = scratch.lanes + 2 * L, *r = scratch.work + padded(F) * block_size;
    for (int k = 0; k < components.count; ++k, lanes += entries * L) {
      V mass = zero();
      for (Index n = 0; n < block_size; n += L) {
        const V product = hn::Mul(load(scratch.relative + k * block_size + n), load(scratch.sum + n));
        store(product, r + n);
        mass = hn::Add(mass, product);
      }
      add_to(lanes, mass);
      if constexpr (diagonal) {
        add_diagonal_moments(F, components.means + k * F, block.points, r, lanes);
      } else {
        all_offsets(components, k, block.points, scratch.work);
        add_full_moments(F, scratch.work, lanes);
      }
    }
  }
};

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
