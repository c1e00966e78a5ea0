// What EM with error covariances does with one component and two vectors of points, which lie side by side: one's
// arithmetic fills the time in which the other's waits for its own. Included once per instruction set.
#if defined(MODEBANK_EM_DECONVOLVE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_EM_DECONVOLVE_INL
#undef MODEBANK_EM_DECONVOLVE_INL
#else
#define MODEBANK_EM_DECONVOLVE_INL
#endif

#include <utility>

#include "mixture/detail/kernels/errors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::em::HWY_NAMESPACE {

struct Pair {
  V a, b;
};

namespace each {

HWY_INLINE Pair splat(double value) { return {em::HWY_NAMESPACE::splat(value), em::HWY_NAMESPACE::splat(value)}; }
HWY_INLINE Pair load(const double* from) { return {em::HWY_NAMESPACE::load(from), em::HWY_NAMESPACE::load(from + L)}; }
HWY_INLINE void store(Pair value, double* to, Index apart) {
  em::HWY_NAMESPACE::store(value.a, to);
  em::HWY_NAMESPACE::store(value.b, to + apart);
}
HWY_INLINE Pair Sub(Pair x, Pair y) { return {hn::Sub(x.a, y.a), hn::Sub(x.b, y.b)}; }
HWY_INLINE Pair Mul(Pair x, Pair y) { return {hn::Mul(x.a, y.a), hn::Mul(x.b, y.b)}; }
HWY_INLINE Pair Neg(Pair x) { return {hn::Neg(x.a), hn::Neg(x.b)}; }
HWY_INLINE Pair MulAdd(Pair x, Pair y, Pair z) { return {hn::MulAdd(x.a, y.a, z.a), hn::MulAdd(x.b, y.b, z.b)}; }
HWY_INLINE Pair NegMulAdd(Pair x, Pair y, Pair z) {
  return {hn::NegMulAdd(x.a, y.a, z.a), hn::NegMulAdd(x.b, y.b, z.b)};
}
HWY_INLINE Pair sound_pivot(Pair pivot, Pair least) {
  return {em::HWY_NAMESPACE::sound_pivot(pivot.a, least.a), em::HWY_NAMESPACE::sound_pivot(pivot.b, least.b)};
}
HWY_INLINE Pair noticeable_pivot(Pair diagonal) {
  return {em::HWY_NAMESPACE::noticeable_pivot(diagonal.a), em::HWY_NAMESPACE::noticeable_pivot(diagonal.b)};
}
HWY_INLINE Pair reciprocal(Pair x) {
  return {batch::HWY_NAMESPACE::reciprocal(x.a), batch::HWY_NAMESPACE::reciprocal(x.b)};
}

}  // namespace each

/// Intermediate values, in the caller's memory.
struct DeconvolutionWork {
  Pair *t, *errors, *x, *y, *row, *scaled, *least, *inverse_pivot;

  static constexpr Index doubles(int features) { return 2 * L * (2 * triangle(features) + 6 * features); }
  DeconvolutionWork(int features, double* memory) {
    Pair* free = reinterpret_cast<Pair*>(memory);
    const auto take = [&](int count) { return std::exchange(free, free + count); };
    t = take(triangle(features)), errors = take(triangle(features)), x = take(features), y = take(features);
    row = take(features), scaled = take(features), least = take(features), inverse_pivot = take(features);
  }
};

template <bool diagonal_>
class Deconvolution {
 public:
  static constexpr bool diagonal = diagonal_;
  using Work = DeconvolutionWork;

  Deconvolution(int features, double* memory) : features_(features), w_(features, memory) {}

  HWY_INLINE void begin(const Block& points) {
    block_ = points;
    for (int i = 0; i < triangle(features_); ++i) w_.errors[i] = each::load(points.errors + i * block_size);
  }

  template <bool logarithmic>
  HWY_INLINE void spread(const double* mean, const double* W, double* expected, Spread<logarithmic> (&of)[2]) {
    whiten(mean, W);
    for (int i = 0; i < features_; ++i)
      w_.least[i] = i == 0 ? each::splat(1.0) : each::noticeable_pivot(w_.t[at(i, i)]);
    const Pair determinant = factor<logarithmic>();
    invert();
    const Pair distance = expect(expected);
    of[0] = {distance.a, determinant.a};
    of[1] = {distance.b, determinant.b};
  }

 private:
  /// The lower triangle of T and y. Packing::unit_rows.
  HWY_INLINE void whiten(const double* mean, const double* W) {
    const int n = features_;
    const double *products = W, *D_ = W + triangle(n), *U = D_ + n;
    for (int i = 0; i < n; ++i) w_.x[i] = each::Sub(each::load(block_.points + i * block_size), each::splat(mean[i]));
    for (int i = 0; i < n; ++i) {
      const double* const u = U + triangle(i - 1);
      Pair sum = w_.x[i];
      for (int l = 0; !diagonal && l < i; ++l) sum = each::MulAdd(each::splat(u[l]), w_.x[l], sum);
      w_.y[i] = each::Mul(sum, each::splat(D_[i]));
      // Row i of U S, then of U S U'.
      for (int j = 0; j <= i; ++j) {
        Pair a = w_.errors[at(i, j)];
        for (int l = 0; !diagonal && l < j; ++l) a = each::MulAdd(each::splat(u[l]), w_.errors[at(j, l)], a);
        for (int l = j; !diagonal && l < i; ++l) a = each::MulAdd(each::splat(u[l]), w_.errors[at(l, j)], a);
        w_.row[j] = a;
      }
      for (int j = 0; j <= i; ++j) {
        Pair sum_j = w_.row[j];
        for (int l = 0; !diagonal && l < j; ++l)
          sum_j = each::MulAdd(w_.row[l], each::splat(U[triangle(j - 1) + l]), sum_j);
        w_.t[at(i, j)] = i == j ? each::MulAdd(sum_j, each::splat(products[at(i, j)]), each::splat(1.0))
                                : each::Mul(sum_j, each::splat(products[at(i, j)]));
      }
    }
  }

  /// L D L' of t in place (unit lower triangle), pivots, which are at least `least`, inverted. The determinant, as
  /// Spread has it: the products of four pivots at most.
  template <bool logarithmic>
  HWY_INLINE Pair factor() {
    const int n = features_;
    constexpr int per_logarithm = 4;
    auto& t = w_.t;
    Pair product, determinant;
    for (int j = 0; j < n; ++j) {
      Pair pivot = t[at(j, j)];
      for (int k = 0; k < j; ++k) {
        Pair z = t[at(j, k)];
        for (int i = 0; i < k; ++i) z = each::NegMulAdd(w_.row[i], t[at(k, i)], z);
        w_.row[k] = z;
      }
      for (int k = 0; k < j; ++k) {
        t[at(j, k)] = each::Mul(w_.row[k], w_.inverse_pivot[k]);
        pivot = each::NegMulAdd(w_.row[k], t[at(j, k)], pivot);
      }
      pivot = each::sound_pivot(pivot, w_.least[j]);
      w_.inverse_pivot[j] = each::reciprocal(pivot);
      product = j % per_logarithm == 0 ? pivot : each::Mul(product, pivot);
      if (j % per_logarithm + 1 < per_logarithm && j + 1 < n) continue;
      const Pair part{part_of_determinant<logarithmic>(product.a), part_of_determinant<logarithmic>(product.b)};
      determinant = j < per_logarithm ? part
                    : logarithmic     ? Pair{hn::Add(determinant.a, part.a), hn::Add(determinant.b, part.b)}
                                      : each::Mul(determinant, part);
    }
    return determinant;
  }

  /// The unit lower triangle in t becomes its inverse.
  HWY_INLINE void invert() {
    const int n = features_;
    auto& t = w_.t;
    for (int i = 1; i < n; ++i)
      for (int j = 0; j < i; ++j) {
        Pair sum = t[at(i, j)];
        for (int k = j + 1; k < i; ++k) sum = each::MulAdd(t[at(i, k)], t[at(k, j)], sum);
        t[at(i, j)] = each::Neg(sum);
      }
  }

  /// z and I - T^-1 to `expected`, from the inverse of the factor; returns y' T^-1 y.
  HWY_INLINE Pair expect(double* expected) {
    const int n = features_;
    const Index per_vector = expectations(n, diagonal) * L;
    const auto& m = w_.t;
    Pair distance;
    for (int i = 0; i < n; ++i) {
      Pair u = w_.y[i];
      for (int j = 0; j < i; ++j) u = each::MulAdd(m[at(i, j)], w_.y[j], u);
      w_.scaled[i] = each::Mul(u, w_.inverse_pivot[i]);
      distance = i == 0 ? each::Mul(u, w_.scaled[i]) : each::MulAdd(u, w_.scaled[i], distance);
    }
    double* second = expected + n * L;
    for (int i = 0; i < n; ++i) {
      Pair z = w_.scaled[i];
      for (int l = i + 1; l < n; ++l) {
        z = each::MulAdd(m[at(l, i)], w_.scaled[l], z);
        w_.row[l] = each::Mul(m[at(l, i)], w_.inverse_pivot[l]);
      }
      each::store(z, expected + i * L, per_vector);
      for (int j = diagonal ? i : 0; j <= i; ++j, second += L) {
        Pair sum = i == j ? each::Sub(each::splat(1.0), w_.inverse_pivot[i])
                          : each::Neg(each::Mul(m[at(i, j)], w_.inverse_pivot[i]));
        for (int l = i + 1; l < n; ++l) sum = each::NegMulAdd(w_.row[l], m[at(l, j)], sum);
        each::store(sum, second, per_vector);
      }
    }
    return distance;
  }

  int features_;
  DeconvolutionWork w_;
  Block block_;
};

}  // namespace modebank::em::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
