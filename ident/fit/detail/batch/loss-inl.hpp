// Robust losses on vectors of residuals, as defined in ident/fit/loss.hpp. D is the tuning constant times sigma, and t
// = r^2 / D^2. `cost` accumulates the objective up to a factor and an offset per window.
#if defined(MODEBANK_BATCH_LOSS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_BATCH_LOSS_INL
#undef MODEBANK_BATCH_LOSS_INL
#else
#define MODEBANK_BATCH_LOSS_INL
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "ident/base/detail/simd-inl.hpp"
#include "ident/model/local_model.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::batch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Values at one residual: psi = rho' r, slope = d psi / d r = rho' + 2 s rho'', weight = rho'.
struct LossTerms {
  V psi, slope, weight;
};

/// Every loss has `quadratic`, `terms(r)` and an accumulator `Cost`. The value of `Cost` is sum rho in units of r^2, up
/// to an offset.
struct TrivialLoss {
  static constexpr bool quadratic = true;
  explicit TrivialLoss(V) {}
  HWY_INLINE LossTerms terms(V r) const { return {r, splat(1.0), splat(1.0)}; }
  struct Cost {
    V sum;
    HWY_INLINE Cost() : sum(zero()) {}
    HWY_INLINE void add(const TrivialLoss&, V r, const LossTerms&) { sum = hn::MulAdd(r, r, sum); }
    HWY_INLINE V value(const TrivialLoss&) const { return sum; }
  };
};

struct HuberLoss {
  static constexpr bool quadratic = false;
  V bend;
  explicit HuberLoss(V scale) : bend(scale) {}
  HWY_INLINE LossTerms terms(V r) const {
    const V psi = hn::Min(hn::Max(r, hn::Neg(bend)), bend);
    const M inside = hn::Le(hn::Abs(r), bend);
    const V one = splat(1.0);
    return {psi, hn::IfThenElseZero(inside, one), hn::IfThenElse(inside, one, hn::Div(bend, hn::Abs(r)))};
  }
  struct Cost {
    V sum;
    HWY_INLINE Cost() : sum(zero()) {}
    HWY_INLINE void add(const HuberLoss&, V r, const LossTerms& at_r) {
      sum = hn::MulAdd(at_r.psi, hn::Sub(hn::Add(r, r), at_r.psi), sum);
    }
    HWY_INLINE V value(const HuberLoss&) const { return sum; }
  };
};

/// Constants of most losses: D^2 and its inverse.
struct ScaledLoss {
  static constexpr bool quadratic = false;
  V inverse_square, square;
  explicit ScaledLoss(const V& scale) : ScaledLoss(hn::Mul(scale, scale), hn::Div(splat(1.0), hn::Mul(scale, scale))) {}
  ScaledLoss(const V& scale_square, const V& inverse) : inverse_square(inverse), square(scale_square) {}
  /// t at residual r.
  HWY_INLINE V relative_square(V r) const { return hn::Mul(hn::Mul(r, r), inverse_square); }
  /// 1 + t at residual r.
  HWY_INLINE V one_more(V r) const { return hn::MulAdd(hn::Mul(r, r), inverse_square, splat(1.0)); }
};

struct SoftLOneLoss : ScaledLoss {
  using ScaledLoss::ScaledLoss;
  HWY_INLINE LossTerms terms(V r) const {
    const V u = one_more(r);
    const V w = reciprocal_root(u);
    return {hn::Mul(w, r), hn::Mul(w, hn::Mul(w, w)), w};
  }
  /// rho = 2 D^2 (sqrt(1 + t) - 1).
  struct Cost {
    V sum;
    HWY_INLINE Cost() : sum(zero()) {}
    HWY_INLINE void add(const SoftLOneLoss& loss, V r, const LossTerms& at_r) {
      const V u = loss.one_more(r);
      sum = hn::MulAdd(u, at_r.weight, sum);
    }
    HWY_INLINE V value(const SoftLOneLoss& loss) const { return hn::Mul(hn::Add(loss.square, loss.square), sum); }
  };
};

struct CauchyLoss : ScaledLoss {
  using ScaledLoss::ScaledLoss;
  HWY_INLINE LossTerms terms(V r) const {
    const V t = relative_square(r);
    const V w = reciprocal(hn::Add(t, splat(1.0)));
    return {hn::Mul(w, r), hn::Mul(hn::Sub(splat(1.0), t), hn::Mul(w, w)), w};
  }
  /// rho = D^2 log(1 + t). Accumulates a product and takes its logarithm before it can overflow.
  struct Cost {
    static constexpr double largest = 1e37;
    static constexpr int factors = 8;
    V sum, product;
    int count = 0;
    HWY_INLINE Cost() : sum(zero()), product(splat(1.0)) {}
    HWY_INLINE void add(const CauchyLoss& loss, V r, const LossTerms&) {
      const V u = loss.one_more(r);
      product = hn::Mul(product, hn::Min(u, splat(largest)));
      if (++count == factors) {
        sum = hn::Add(sum, hn::Log(D(), product));
        product = splat(1.0);
        count = 0;
      }
    }
    HWY_INLINE V value(const CauchyLoss& loss) const {
      return hn::Mul(loss.square, hn::Add(sum, hn::Log(D(), product)));
    }
  };
};

struct TukeyLoss : ScaledLoss {
  using ScaledLoss::ScaledLoss;
  HWY_INLINE LossTerms terms(V r) const {
    const V t = relative_square(r);
    const V m = hn::Max(hn::Sub(splat(1.0), t), zero());
    const V w = hn::Mul(m, m);
    return {hn::Mul(w, r), hn::Mul(m, hn::NegMulAdd(splat(5.0), t, splat(1.0))), w};
  }
  /// rho = D^2 / 3 (1 - m^3).
  struct Cost {
    V sum;
    HWY_INLINE Cost() : sum(zero()) {}
    HWY_INLINE void add(const TukeyLoss& loss, V r, const LossTerms& at_r) {
      const V t = loss.relative_square(r);
      const V m = hn::Max(hn::Sub(splat(1.0), t), zero());
      sum = hn::Add(sum, hn::NegMulAdd(at_r.weight, m, splat(1.0)));
    }
    HWY_INLINE V value(const TukeyLoss& loss) const { return hn::Mul(hn::Mul(loss.square, splat(1.0 / 3.0)), sum); }
  };
};

struct ArctanLoss : ScaledLoss {
  using ScaledLoss::ScaledLoss;
  HWY_INLINE LossTerms terms(V r) const {
    const V t = relative_square(r), t2 = hn::Mul(t, t);
    const V w = hn::Div(splat(1.0), hn::Add(splat(1.0), t2));
    return {hn::Mul(w, r), hn::Mul(hn::Mul(w, w), hn::NegMulAdd(splat(3.0), t2, splat(1.0))), w};
  }
  /// rho = D^2 atan(t).
  struct Cost {
    V sum;
    HWY_INLINE Cost() : sum(zero()) {}
    HWY_INLINE void add(const ArctanLoss& loss, V r, const LossTerms&) {
      sum = hn::Add(sum, hn::Atan(D(), loss.relative_square(r)));
    }
    HWY_INLINE V value(const ArctanLoss& loss) const { return hn::Mul(loss.square, sum); }
  };
};

template <class LossT>
HWY_INLINE V rho_of(const LossT& loss, V r, const LossTerms& at_r) {
  typename LossT::Cost cost;
  cost.add(loss, r, at_r);
  return cost.value(loss);
}

/// A loss that is chosen at run time, for shapes without a kernel per loss.
struct AnyLoss {
  static constexpr bool quadratic = false;
  Loss kind;
  V scale, inverse_square, square;
  AnyLoss(Loss loss, V tuning)
      : kind(loss),
        scale(tuning),
        inverse_square(hn::Div(splat(1.0), hn::Mul(tuning, tuning))),
        square(hn::Mul(tuning, tuning)) {}
  HWY_INLINE LossTerms terms(V r) const {
    switch (kind) {
      case Loss::trivial:
        return TrivialLoss(scale).terms(r);
      case Loss::huber:
        return HuberLoss(scale).terms(r);
      case Loss::cauchy:
        return CauchyLoss(square, inverse_square).terms(r);
      case Loss::softlone:
        return SoftLOneLoss(square, inverse_square).terms(r);
      case Loss::tukey:
        return TukeyLoss(square, inverse_square).terms(r);
      default:
        return ArctanLoss(square, inverse_square).terms(r);
    }
  }
  HWY_INLINE V rho(V r, const LossTerms& at_r) const {
    switch (kind) {
      case Loss::trivial:
        return rho_of(TrivialLoss(scale), r, at_r);
      case Loss::huber:
        return rho_of(HuberLoss(scale), r, at_r);
      case Loss::cauchy:
        return rho_of(CauchyLoss(square, inverse_square), r, at_r);
      case Loss::softlone:
        return rho_of(SoftLOneLoss(square, inverse_square), r, at_r);
      case Loss::tukey:
        return rho_of(TukeyLoss(square, inverse_square), r, at_r);
      default:
        return rho_of(ArctanLoss(square, inverse_square), r, at_r);
    }
  }
  struct Cost {
    V sum;
    HWY_INLINE Cost() : sum(zero()) {}
    HWY_INLINE void add(const AnyLoss& loss, V r, const LossTerms& at_r) { sum = hn::Add(sum, loss.rho(r, at_r)); }
    HWY_INLINE V value(const AnyLoss&) const { return sum; }
  };
};

}  // namespace modebank::batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
