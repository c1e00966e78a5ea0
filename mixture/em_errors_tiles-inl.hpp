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
  HWY_INLINE MatrixTile(const double* from, Index to_row, Index to_column) {
    for (int i = 0; i < moment_rows; ++i)
      for (int j = 0; j < tile; ++j) v[i][j] = load(from + i * to_row + j * to_column);
  }
  HWY_INLINE void put(double* to, Index to_row, Index to_column) const {
    for (int i = 0; i < moment_rows; ++i)
      for (int j = 0; j < tile; ++j) store(v[i][j], to + i * to_row + j * to_column);
  }

  /// Adds (or subtracts) the products left(l, i) right(l, j), l = first .. last - 1.
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

/// Lower triangles are stored without what is above their diagonal blocks, so that all of them stay in the nearest
/// cache: `Rows` holds a whole tile of rows column by column, `Columns` a whole tile of columns row by row.
struct Rows {
  double* data;
  static Index size(int p) { return Index(p) * (p + tile) / 2; }
  HWY_INLINE double* at_entry(int block, int i, int j) const {
    return data + (Index(block) * (block + tile) / 2 + j * tile + i - block) * L;
  }
};
struct Columns {
  double* data;
  int p;
  HWY_INLINE double* at_entry(int i, int block, int j) const {
    return data + (Index(block) * (2 * p + tile - block) / 2 + (i - block) * tile + j - block) * L;
  }
};

template <bool diagonal_>
struct TileErrors {
  static constexpr bool diagonal = diagonal_;
  static int features(int n) { return n; }
  static Index work(int n) {
    const int p = padded(n);
    return (2 * (p + 1) * p + tile * p + 3 * Rows::size(p) + 3 * p) * L;
  }

  // Matrices are p x p, one vector per entry, p the number of features padded to whole tiles.
  int n, p;
  double *S, *x;                       ///< of each of the two vectors of points, by rows
  double* A;                           ///< a tile of rows of W S, column by column
  Rows T, Z;                           ///< T, then L of it; L D
  Columns M, scaled_M;                 ///< L^-1; D^-1 L^-1, in the memory of Z
  double *inverse_pivot, *y, *scaled;  ///< D^-1; W (x - mu); D^-1 M y

  TileErrors(int n_, double* work) : n(n_), p(padded(n_)) {
    const auto take = [&](Index vectors) {
      double* const taken = work;
      work += vectors * L;
      return taken;
    };
    S = take(2 * Index(p) * p), x = take(2 * p), A = take(tile * p);
    T.data = take(Rows::size(p)), Z.data = take(Rows::size(p));
    M = {take(Rows::size(p)), p}, scaled_M = {Z.data, p};
    inverse_pivot = take(p), y = take(p), scaled = take(p);
  }

  HWY_INLINE void begin(const Block& block) {
    for (int v = 0; v < 2; ++v) {
      double* const whole = S + v * p * p * L;
      for (int i = 0; i < p; ++i) {
        store(i < n ? load(block.points + i * block_size + v * L) : zero(), x + (v * p + i) * L);
        for (int j = 0; j <= i; ++j) {
          const V s = i < n ? load(block.errors + at(i, j) * block_size + v * L) : zero();
          store(s, whole + (i * p + j) * L);
          store(s, whole + (j * p + i) * L);
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
      store(w, scaled + i * L);
      store(hn::Mul(w, hn::Sub(load(points + i * L), splat(i < n ? mean[i] : 0.0))), y + i * L);
    }
    for (int i = 0; i < p; i += moment_rows) {
      const int block = i / tile * tile;
      for (int j = 0; j <= block; j += tile) {
        MatrixTile t(i, j);
        for (int r = 0; r < moment_rows; ++r)
          for (int c = 0; c < tile; ++c) {
            const V w = hn::Mul(load(scaled + (i + r) * L), load(scaled + (j + c) * L));
            t.v[r][c] = hn::MulAdd(w, load(errors + ((i + r) * p + j + c) * L), t.v[r][c]);
          }
        t.put(T.at_entry(block, i, j), L, tile * L);
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
          [&](int l, int c) { return load(errors + (l * p + j + c) * L); });
      sum.put(A + j * tile * L, L, tile * L);
    }
    for (int j = 0; j <= block; j += tile) {
      const double* const v = tile_of(W, j);
      MatrixTile sum(i, j);
      sum.multiply<false>(
          0, j + tile < n ? j + tile : n, [&](int l, int r) { return load(A + (l * tile + r) * L); },
          [&](int l, int c) { return splat(v[l * tile + c]); });
      sum.put(T.at_entry(block, i, j), L, tile * L);
    }
  }

  /// Rows `i` to the left of their diagonal block: L D, and L.
  HWY_INLINE void factor_rows(int i, int block) const {
    const double* const rows = Z.at_entry(block, i, 0);
    for (int j = 0; j < block; j += tile) {
      const double* const other = T.at_entry(j, j, 0);
      MatrixTile z(T.at_entry(block, i, j), L, tile * L);
      z.multiply<true>(
          0, j, [&](int l, int r) { return load(rows + (l * tile + r) * L); },
          [&](int l, int c) { return load(other + (l * tile + c) * L); });
      for (int c = 0; c < tile; ++c) {
        for (int d = 0; d < c; ++d)
          for (int r = 0; r < moment_rows; ++r)
            z.v[r][c] = hn::NegMulAdd(z.v[r][d], load(other + ((j + d) * tile + c) * L), z.v[r][c]);
        for (int r = 0; r < moment_rows; ++r)
          store(hn::Mul(z.v[r][c], load(inverse_pivot + (j + c) * L)), T.at_entry(block, i + r, j + c));
      }
      z.put(Z.at_entry(block, i, j), L, tile * L);
    }
  }

  /// The factor of a diagonal block, its inverse and its determinant.
  HWY_INLINE V factor_diagonal_block(int block) const {
    using Small = SmallErrors<tile, diagonal>;
    V t[triangle(tile)], least[tile], inverse[tile];
    const double *const left = Z.at_entry(block, block, 0), *const right = T.at_entry(block, block, 0);
    for (int i = 0; i < tile; ++i) least[i] = noticeable_pivot(load(T.at_entry(block, block + i, block + i)));
    for (int i = 0; i < tile; i += moment_rows) {
      MatrixTile rest(T.at_entry(block, block + i, block), L, tile * L);
      rest.multiply<true>(
          0, block, [&](int l, int r) { return load(left + (l * tile + i + r) * L); },
          [&](int l, int c) { return load(right + (l * tile + c) * L); });
      rest.put(T.at_entry(block, block + i, block), L, tile * L);
    }
    for (int i = 0; i < tile; ++i)
      for (int j = 0; j <= i; ++j) t[at(i, j)] = load(T.at_entry(block, block + i, block + j));
    const V determinant = Small::factor(t, least, inverse);
    for (int i = 0; i < tile; ++i) {
      store(inverse[i], inverse_pivot + (block + i) * L);
      for (int j = 0; j < i; ++j) store(t[at(i, j)], T.at_entry(block, block + i, block + j));
    }
    Small::invert(t);
    for (int i = 0; i < tile; ++i)
      for (int j = 0; j < tile; ++j)
        store(j < i ? t[at(i, j)] : splat(i == j ? 1.0 : 0.0), M.at_entry(block + i, block, block + j));
    return determinant;
  }

  /// Rows `i` of L^-1 to the left of their diagonal block.
  HWY_INLINE void invert_rows(int i, int block) const {
    const double* const rows = T.at_entry(block, i, 0);
    for (int j = 0; j < block; j += tile) {
      const double* const columns = M.at_entry(0, j, j);
      MatrixTile m(0, tile);
      m.multiply<true>(
          j, i, [&](int l, int r) { return load(rows + (l * tile + r) * L); },
          [&](int l, int c) { return load(columns + (l * tile + c) * L); });
      for (int r = 1; r < moment_rows; ++r)
        for (int s = 0; s < r; ++s) {
          const V factor = load(T.at_entry(block, i + r, i + s));
          for (int c = 0; c < tile; ++c) m.v[r][c] = hn::NegMulAdd(factor, m.v[s][c], m.v[r][c]);
        }
      m.put(M.at_entry(i, j, j), tile * L, L);
    }
  }

  /// D^-1 M y to `scaled`; returns y' T^-1 y.
  HWY_INLINE V solve() const {
    V distance = zero();
    for (int block = 0; block < p; block += tile) {
      V u[tile];
      for (int i = 0; i < tile; ++i) u[i] = zero();
      for (int j = 0; j <= block; j += tile) {
        const double* const m = M.at_entry(block, j, j);
        for (int c = 0; c < tile; ++c) {
          const V right = load(y + (j + c) * L);
          for (int i = 0; i < tile; ++i) u[i] = hn::MulAdd(load(m + (i * tile + c) * L), right, u[i]);
        }
      }
      for (int i = 0; i < tile; ++i) {
        const V part = hn::Mul(u[i], load(inverse_pivot + (block + i) * L));
        distance = hn::MulAdd(u[i], part, distance);
        store(part, scaled + (block + i) * L);
      }
    }
    return distance;
  }

  /// z, and with it the diagonal of I - T^-1 where that is all that is asked for, else D^-1 M.
  HWY_INLINE void expect_columns(double* expected) const {
    for (int column = 0; column < n; column += tile) {
      const double* const m = M.at_entry(0, column, column);
      double* const to = scaled_M.at_entry(0, column, column);
      V z[tile], second[tile];
      for (int c = 0; c < tile; ++c) z[c] = zero(), second[c] = splat(1.0);
      for (int l = column; l < n; ++l) {
        const V right = load(scaled + l * L), inverse = load(inverse_pivot + l * L);
        for (int c = 0; c < tile; ++c) {
          const V entry = load(m + (l * tile + c) * L), scaled_entry = hn::Mul(entry, inverse);
          z[c] = hn::MulAdd(entry, right, z[c]);
          if constexpr (diagonal)
            second[c] = hn::NegMulAdd(scaled_entry, entry, second[c]);
          else
            store(scaled_entry, to + (l * tile + c) * L);
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
    for (int i = 0; i < n; i += moment_rows) {
      const double* const left = scaled_M.at_entry(0, i / tile * tile, i);
      for (int j = 0; j < i + moment_rows; j += tile) {
        const double* const right = M.at_entry(0, j, j);
        MatrixTile second(i, j);
        second.multiply<true>(
            i, n, [&](int l, int r) { return load(left + (l * tile + r) * L); },
            [&](int l, int c) { return load(right + (l * tile + c) * L); });
        for (int r = 0; r < moment_rows && i + r < n; ++r)
          for (int c = 0; c < tile && j + c <= i + r; ++c) store(second.v[r][c], expected + (n + at(i + r, j + c)) * L);
      }
    }
  }

  template <bool logarithmic>
  HWY_INLINE Spread<logarithmic> spread_vector(int v, const double* mean, const double* W, double* expected) const {
    const double *points = x + v * p * L, *errors = S + v * p * p * L;
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
    const V distance = solve();
    expect_columns(expected);
    if constexpr (!diagonal) expect_squares(expected);
    return {distance, determinant};
  }

  template <bool logarithmic>
  HWY_INLINE void spread(const double* mean, const double* W, double* expected, Spread<logarithmic> (&of)[2]) const {
    for (int v = 0; v < 2; ++v)
      of[v] = spread_vector<logarithmic>(v, mean, W, expected + v * expectations(n, diagonal) * L);
  }
};

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
