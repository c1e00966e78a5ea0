// Least squares and the rank of the regressors by orthogonalisation, which is accurate for all data.
#if defined(MODEBANK_BATCH_ROTATION_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_BATCH_ROTATION_INL
#undef MODEBANK_BATCH_ROTATION_INL
#else
#define MODEBANK_BATCH_ROTATION_INL
#endif

#include <hwy/highway.h>

#include "ident/fit/detail/batch/newton-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::batch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Regressors are orthogonalised against the previous regressors. A regressor counts as dependent if at most this share
/// of its norm remains.
inline constexpr double dependent = 1e-9;
/// Singular values between `dependent` and this share of the largest one need the singular value decomposition of the
/// slow path. The reason: excitation_tolerance lies in that range.
inline constexpr double clearly_independent = 1e-5;

/// Samples, least squares and scale of the windows, computed before any loss.
template <int Q>
struct Start {
  Symmetric<Q> gram;      // X'X
  Symmetric<Q> unscaled;  // (X'X)^-1; undefined if rank deficient
  V moment[Q];            // X'y
  V theta[Q];             // least squares; undefined if rank deficient
  V square_sum, count, rank, condition, sigma;
  M clear;      // lanes whose rank is known with certainty
  M deficient;  // lanes of `clear` that are rank deficient
};

/// Orthogonalises the columns of regressors and increments one after another by modified Gram-Schmidt, with the
/// increments as last column (backward stable: Bjorck 1967). Leaves the least-squares residuals in the last column.
template <int Q>
struct Orthogonal {
  V r[Q][Q];  // column j of the triangle: r[j][0..j]
  V z[Q];     // Q' y
  V norm[Q];  // norms of the regressors
  M kept[Q];
};

template <int Q>
HWY_NOINLINE Orthogonal<Q> orthogonalise(const View& view, double* scratch) {
  const D d;
  const Index lanes = static_cast<Index>(hn::Lanes(d)), stride = lanes * (Q + 1);
  Orthogonal<Q> o;
  V square[Q];
  for (V& entry : square) entry = zero();
  for (Index i = 0; i < view.length; ++i) {
    for (int j = 0; j < Q; ++j) {
      const V x = row(view, view.regressors[j], i);
      square[j] = hn::MulAdd(x, x, square[j]);
      hn::Store(x, d, scratch + i * stride + j * lanes);
    }
    hn::Store(row(view, view.increments, i), d, scratch + i * stride + Q * lanes);
  }
  for (int j = 0; j < Q; ++j) o.norm[j] = hn::Sqrt(square[j]);
  for (int j = 0; j < Q; ++j) {
    for (int k = 0; k < Q; ++k) o.r[j][k] = k < j ? o.r[j][k] : zero();
    const V length = hn::Sqrt(square[j]);
    o.kept[j] = hn::Gt(length, hn::Mul(splat(dependent), o.norm[j]));
    o.r[j][j] = length;
    const V inverse = hn::IfThenElseZero(o.kept[j], hn::Div(splat(1.0), length));
    V product[Q + 1];
    for (V& entry : product) entry = zero();
    for (Index i = 0; i < view.length; ++i) {
      double* const at_i = scratch + i * stride;
      const V q = hn::Mul(hn::Load(d, at_i + j * lanes), inverse);
      hn::Store(q, d, at_i + j * lanes);
      for (int k = j + 1; k <= Q; ++k) product[k] = hn::MulAdd(q, hn::Load(d, at_i + k * lanes), product[k]);
    }
    for (int k = j + 1; k < Q; ++k) o.r[k][j] = product[k];
    o.z[j] = product[Q];
    V next = zero();
    for (Index i = 0; i < view.length; ++i) {
      double* const at_i = scratch + i * stride;
      const V q = hn::Load(d, at_i + j * lanes);
      for (int k = j + 1; k <= Q; ++k) {
        const V rest = hn::NegMulAdd(product[k], q, hn::Load(d, at_i + k * lanes));
        hn::Store(rest, d, at_i + k * lanes);
        if (k == j + 1) next = hn::MulAdd(rest, rest, next);
      }
    }
    if (j + 1 < Q) square[j + 1] = next;
  }
  return o;
}

/// Rank and condition, from the triangle. Its columns are scaled to unit norm of the regressors.
template <int Q>
HWY_INLINE void judge_rank(const Orthogonal<Q>& o, Start<Q>& start) {
  V column[Q][Q], sigma[Q];
  for (int j = 0; j < Q; ++j) {
    const V scale = hn::IfThenElse(hn::Gt(o.norm[j], zero()), hn::Div(splat(1.0), o.norm[j]), splat(1.0));
    for (int k = 0; k < Q; ++k) column[j][k] = k <= j ? hn::Mul(o.r[j][k], scale) : zero();
  }
  singular_values(column, sigma);
  V least = sigma[0], largest = sigma[0], kept = zero();
  for (int j = 1; j < Q; ++j) {
    least = hn::Min(least, sigma[j]);
    largest = hn::Max(largest, sigma[j]);
  }
  start.condition =
      hn::IfThenElse(hn::Gt(least, zero()), hn::Div(largest, least), splat(std::numeric_limits<double>::infinity()));
  start.rank = zero();
  start.clear = hn::Eq(zero(), zero());
  for (int j = 0; j < Q; ++j) {
    kept = hn::Add(kept, hn::IfThenElseZero(o.kept[j], splat(1.0)));
    start.rank = hn::Add(
        start.rank, hn::IfThenElseZero(hn::Gt(sigma[j], hn::Mul(splat(excitation_tolerance), largest)), splat(1.0)));
    const M doubtful = hn::And(hn::Gt(sigma[j], hn::Mul(splat(dependent), largest)),
                               hn::Lt(sigma[j], hn::Mul(splat(clearly_independent), largest)));
    start.clear = hn::AndNot(doubtful, start.clear);
  }
  start.clear = hn::And(start.clear, hn::Eq(kept, start.rank));
  start.deficient = hn::Lt(start.rank, splat(Q));
}

/// theta = R^-1 z, X'X = R'R and its inverse R^-1 R^-T.
template <int Q>
HWY_INLINE void solve_triangle(const Orthogonal<Q>& o, Start<Q>& start) {
  V r[Q][Q];  // rows of dependent columns are excluded, because they contain rounding errors
  for (int j = 0; j < Q; ++j)
    for (int k = 0; k <= j; ++k) r[j][k] = hn::IfThenElseZero(o.kept[k], o.r[j][k]);
  for (int i = 0; i < Q; ++i)
    for (int j = 0; j <= i; ++j) {
      V sum = hn::Mul(r[i][0], r[j][0]);
      for (int k = 1; k <= j; ++k) sum = hn::MulAdd(r[i][k], r[j][k], sum);
      start.gram.a[at(i, j)] = sum;
    }
  V inverse[Q][Q];  // column j of R^-1
  for (int j = 0; j < Q; ++j)
    for (int i = j; i >= 0; --i) {
      V sum = i == j ? splat(1.0) : zero();
      for (int k = i + 1; k <= j; ++k) sum = hn::NegMulAdd(r[k][i], inverse[j][k], sum);
      inverse[j][i] = hn::Div(sum, r[i][i]);
    }
  for (int i = 0; i < Q; ++i) {
    V sum = hn::Mul(inverse[i][i], o.z[i]);
    for (int k = i + 1; k < Q; ++k) sum = hn::MulAdd(inverse[k][i], o.z[k], sum);
    start.theta[i] = sum;
    start.moment[i] = hn::Mul(r[i][0], o.z[0]);
    for (int k = 1; k <= i; ++k) start.moment[i] = hn::MulAdd(r[i][k], o.z[k], start.moment[i]);
    for (int j = 0; j <= i; ++j) {
      V entry = zero();
      for (int k = i; k < Q; ++k) entry = hn::MulAdd(inverse[k][i], inverse[k][j], entry);
      start.unscaled.a[at(i, j)] = entry;
    }
  }
}

/// A search start by orthogonalisation. Leaves the residuals in the last column of the scratch rows.
template <int Q>
HWY_NOINLINE void prepare_by_rotation(const View& view, double* scratch, Start<Q>& start) {
  const Orthogonal<Q> o = orthogonalise<Q>(view, scratch);
  judge_rank(o, start);
  solve_triangle(o, start);
  start.square_sum = zero();
  for (Index i = 0; i < view.length; ++i) {
    const V y = row(view, view.increments, i);
    start.square_sum = hn::MulAdd(y, y, start.square_sum);
  }
}

}  // namespace modebank::batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
