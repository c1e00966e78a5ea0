// EM with error covariances on any number of features: the matrices of one vector of points and one component lie in
// memory and are computed in tiles of registers, four columns wide. Included once per instruction set.
#if defined(MODEBANK_EM_ERRORS_TILES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_EM_ERRORS_TILES_INL
#undef MODEBANK_EM_ERRORS_TILES_INL
#else
#define MODEBANK_EM_ERRORS_TILES_INL
#endif

#include "mixture/em_errors_small-inl.hpp"
#include "mixture/em_tiles-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::em::HWY_NAMESPACE {

/// A tile of a matrix: moment_rows x tile.
struct MatrixTile {
  V v[moment_rows][tile];

  /// Of the unit matrix.
  HWY_INLINE MatrixTile(int row, int column) {
    for (int i = 0; i < moment_rows; ++i)
      for (int j = 0; j < tile; ++j) v[i][j] = splat(row + i == column + j ? 1.0 : 0.0);
  }
  HWY_INLINE MatrixTile(const double* from, Index row_stride) {
    for (int i = 0; i < moment_rows; ++i)
      for (int j = 0; j < tile; ++j) v[i][j] = load(from + i * row_stride + j * L);
  }
  HWY_INLINE void put(double* to, Index row_stride) const {
    for (int i = 0; i < moment_rows; ++i)
      for (int j = 0; j < tile; ++j) store(v[i][j], to + i * row_stride + j * L);
  }

  /// Adds (or subtracts) the products left(i, l) right(l, j), l = first .. last - 1.
  template <bool subtract, class Left, class Right>
  HWY_INLINE void multiply(int first, int last, Left left, Right right) {
    for (int l = first; l < last; ++l) {
      V b[tile];
      for (int j = 0; j < tile; ++j) b[j] = right(l, j);
      for (int i = 0; i < moment_rows; ++i) {
        const V a = left(l, i);
        for (int j = 0; j < tile; ++j)
          v[i][j] = subtract ? hn::NegMulAdd(a, b[j], v[i][j]) : hn::MulAdd(a, b[j], v[i][j]);
      }
    }
  }
};

template <bool diagonal_>
struct TileErrors {
  static constexpr bool diagonal = diagonal_;
  static int features(int n) { return n; }
  static Index work(int n) { return (6 * padded(n) + 5) * padded(n) * L; }

  // Matrices are p x p and by rows, one vector per entry, p the number of features padded to whole tiles.
  int n, p;
  Index row;                           ///< doubles from row to row
  double *S, *x;                       ///< of each of the two vectors of points
  double* A;                           ///< W S, later D^-1 M
  double *T, *Z, *M;                   ///< T, then L of it; L D; L^-1
  double *inverse_pivot, *y, *scaled;  ///< D^-1; W (x - mu); D^-1 M y

  TileErrors(int n_, double* work) : n(n_), p(padded(n_)), row(p * L) {
    const auto take = [&](Index vectors) {
      double* const taken = work;
      work += vectors * L;
      return taken;
    };
    const Index square = Index(p) * p;
    S = take(2 * square), x = take(2 * p), A = take(square), T = take(square), Z = take(square), M = take(square);
    inverse_pivot = take(p), y = take(p), scaled = take(p);
  }

  HWY_INLINE double* entry(double* matrix, int i, int j) const { return matrix + i * row + j * L; }

  HWY_INLINE void begin(const Block& block) {
    for (int v = 0; v < 2; ++v) {
      double* const whole = S + v * p * row;
      for (int i = 0; i < p; ++i) {
        store(i < n ? load(block.points + i * block_size + v * L) : zero(), x + (v * p + i) * L);
        for (int j = 0; j <= i; ++j) {
          const V s = i < n ? load(block.errors + at(i, j) * block_size + v * L) : zero();
          store(s, entry(whole, i, j));
          store(s, entry(whole, j, i));
        }
      }
    }
  }

  /// Four rows of W, column by column.
  static HWY_INLINE const double* tile_of(const double* W, int first_row) {
    return W + first_row * (first_row + tile) / 2;
  }

  HWY_INLINE void whiten_diagonal(const double* points, const double* errors, const double* mean,
                                  const double* W) const {
    for (int i = 0; i < p; ++i) {
      const V w = splat(i < n ? W[i] : 0.0);
      store(i < n ? hn::Mul(w, hn::Sub(load(points + i * L), splat(mean[i]))) : zero(), y + i * L);
      for (int j = 0; j <= i; ++j) {
        const V s = i < n ? hn::Mul(hn::Mul(w, splat(W[j])), load(errors + i * row + j * L)) : zero();
        store(i == j ? hn::Add(s, splat(1.0)) : s, entry(T, i, j));
      }
    }
  }

  HWY_INLINE void whiten_full(const double* points, const double* errors, const double* mean, const double* W) const {
    for (int i = 0; i < n; ++i) store(hn::Sub(load(points + i * L), splat(mean[i])), scaled + i * L);
    for (int block = 0; block < p; block += tile) {
      const double* const w = tile_of(W, block);
      V sum[tile];
      for (int i = 0; i < tile; ++i) sum[i] = zero();
      for (int l = 0; l < block + tile && l < n; ++l)
        for (int i = 0; i < tile; ++i) sum[i] = hn::MulAdd(splat(w[l * tile + i]), load(scaled + l * L), sum[i]);
      for (int i = 0; i < tile; ++i) store(sum[i], y + (block + i) * L);
      for (int i = block; i < block + tile; i += moment_rows) whiten_rows(i, block, errors, W);
    }
  }

  HWY_INLINE void whiten_rows(int i, int block, const double* errors, const double* W) const {
    const double* const w = tile_of(W, block) + (i - block);
    for (int j = 0; j <= block; j += tile) {
      MatrixTile sum(0, tile);
      sum.multiply<false>(
          0, i + moment_rows < n ? i + moment_rows : n, [&](int l, int r) { return splat(w[l * tile + r]); },
          [&](int l, int c) { return load(errors + l * row + (j + c) * L); });
      sum.put(entry(A, i, j), row);
    }
    for (int j = 0; j <= block; j += tile) {
      const double* const v = tile_of(W, j);
      MatrixTile sum(i, j);
      sum.multiply<false>(
          0, j + tile < n ? j + tile : n, [&](int l, int r) { return load(entry(A, i + r, l)); },
          [&](int l, int c) { return splat(v[l * tile + c]); });
      sum.put(entry(T, i, j), row);
    }
  }

  /// Rows `i` to the left of their diagonal block: L D, and L.
  HWY_INLINE void factor_rows(int i, int block) const {
    for (int j = 0; j < block; j += tile) {
      MatrixTile z(entry(T, i, j), row);
      z.multiply<true>(
          0, j, [&](int l, int r) { return load(entry(Z, i + r, l)); },
          [&](int l, int c) { return load(entry(T, j + c, l)); });
      for (int c = 0; c < tile; ++c) {
        for (int d = 0; d < c; ++d)
          for (int r = 0; r < moment_rows; ++r)
            z.v[r][c] = hn::NegMulAdd(z.v[r][d], load(entry(T, j + c, j + d)), z.v[r][c]);
        for (int r = 0; r < moment_rows; ++r)
          store(hn::Mul(z.v[r][c], load(inverse_pivot + (j + c) * L)), entry(T, i + r, j + c));
      }
      z.put(entry(Z, i, j), row);
    }
  }

  /// The factor of a diagonal block, its inverse and its determinant.
  HWY_INLINE V factor_diagonal_block(int block) const {
    using Small = SmallErrors<tile, diagonal>;
    V t[triangle(tile)], least[tile], inverse[tile];
    for (int i = 0; i < tile; ++i) least[i] = noticeable_pivot(load(entry(T, block + i, block + i)));
    for (int i = block; i < block + tile; i += moment_rows) {
      MatrixTile rest(entry(T, i, block), row);
      rest.multiply<true>(
          0, block, [&](int l, int r) { return load(entry(Z, i + r, l)); },
          [&](int l, int c) { return load(entry(T, block + c, l)); });
      rest.put(entry(T, i, block), row);
    }
    for (int i = 0; i < tile; ++i)
      for (int j = 0; j <= i; ++j) t[at(i, j)] = load(entry(T, block + i, block + j));
    const V determinant = Small::factor(t, least, inverse);
    for (int i = 0; i < tile; ++i) {
      store(inverse[i], inverse_pivot + (block + i) * L);
      for (int j = 0; j < i; ++j) store(t[at(i, j)], entry(T, block + i, block + j));
    }
    Small::invert(t);
    for (int i = 0; i < tile; ++i)
      for (int j = 0; j < tile; ++j)
        store(j < i ? t[at(i, j)] : splat(i == j ? 1.0 : 0.0), entry(M, block + i, block + j));
    return determinant;
  }

  /// Rows `i` of L^-1 to the left of their diagonal block.
  HWY_INLINE void invert_rows(int i, int block) const {
    for (int j = 0; j < block; j += tile) {
      MatrixTile m(0, tile);
      m.multiply<true>(
          j, i, [&](int l, int r) { return load(entry(T, i + r, l)); },
          [&](int l, int c) { return load(entry(M, l, j + c)); });
      for (int r = 1; r < moment_rows; ++r)
        for (int s = 0; s < r; ++s) {
          const V factor = load(entry(T, i + r, i + s));
          for (int c = 0; c < tile; ++c) m.v[r][c] = hn::NegMulAdd(factor, m.v[s][c], m.v[r][c]);
        }
      m.put(entry(M, i, j), row);
    }
  }

  /// D^-1 M y to `scaled`; returns y' T^-1 y.
  HWY_INLINE V solve() const {
    V distance = zero();
    for (int block = 0; block < p; block += tile) {
      V u[tile];
      for (int i = 0; i < tile; ++i) u[i] = zero();
      for (int l = 0; l < block + tile; ++l) {
        const V right = load(y + l * L);
        for (int i = 0; i < tile; ++i) u[i] = hn::MulAdd(load(entry(M, block + i, l)), right, u[i]);
      }
      for (int i = 0; i < tile; ++i) {
        const V part = hn::Mul(u[i], load(inverse_pivot + (block + i) * L));
        distance = hn::MulAdd(u[i], part, distance);
        store(part, scaled + (block + i) * L);
      }
    }
    return distance;
  }

  /// z, and with it the diagonal of I - T^-1 where that is all that is asked for.
  HWY_INLINE void expect_columns(double* expected) const {
    for (int column = 0; column < n; column += tile) {
      V z[tile], second[tile];
      for (int c = 0; c < tile; ++c) z[c] = zero(), second[c] = splat(1.0);
      for (int l = column; l < n; ++l) {
        const V right = load(scaled + l * L), inverse = load(inverse_pivot + l * L);
        for (int c = 0; c < tile; ++c) {
          const V m = load(entry(M, l, column + c));
          z[c] = hn::MulAdd(m, right, z[c]);
          if constexpr (diagonal) second[c] = hn::NegMulAdd(hn::Mul(m, inverse), m, second[c]);
        }
      }
      for (int c = 0; c < tile && column + c < n; ++c) {
        store(z[c], expected + (column + c) * L);
        if constexpr (diagonal) store(second[c], expected + (n + column + c) * L);
      }
    }
  }

  /// The lower triangle of I - T^-1.
  HWY_INLINE void expect_squares(double* expected) const {
    for (int l = 0; l < n; ++l) {
      const V inverse = load(inverse_pivot + l * L);
      for (int j = 0; j <= l; ++j) store(hn::Mul(load(entry(M, l, j)), inverse), entry(A, l, j));
      for (int j = l + 1; j < l / tile * tile + tile; ++j) store(zero(), entry(A, l, j));
    }
    for (int i = 0; i < n; i += moment_rows)
      for (int j = 0; j < i + moment_rows; j += tile) {
        MatrixTile second(i, j);
        second.multiply<true>(
            i, n, [&](int l, int r) { return load(entry(A, l, i + r)); },
            [&](int l, int c) { return load(entry(M, l, j + c)); });
        for (int r = 0; r < moment_rows && i + r < n; ++r)
          for (int c = 0; c < tile && j + c <= i + r; ++c) store(second.v[r][c], expected + (n + at(i + r, j + c)) * L);
      }
  }

  template <bool logarithmic>
  HWY_INLINE void spread(const double* mean, const double* W, Spread<logarithmic> (&out)[2], double* expected) const {
    for (int v = 0; v < 2; ++v) {
      const double *points = x + v * row, *errors = S + v * p * row;
      if constexpr (diagonal)
        whiten_diagonal(points, errors, mean, W);
      else
        whiten_full(points, errors, mean, W);
      V determinant = splat(logarithmic ? 0.0 : 1.0);
      for (int block = 0; block < p; block += tile) {
        for (int i = block; i < block + tile; i += moment_rows) factor_rows(i, block);
        const V part = part_of_determinant<logarithmic>(factor_diagonal_block(block));
        determinant = logarithmic ? hn::Add(determinant, part) : hn::Mul(determinant, part);
        for (int i = block; i < block + tile; i += moment_rows) invert_rows(i, block);
      }
      out[v].determinant = determinant;
      out[v].distance = solve();
      expect_columns(expected + v * expectations(n, diagonal) * L);
      if constexpr (!diagonal) expect_squares(expected + v * expectations(n, diagonal) * L);
    }
  }
};

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
