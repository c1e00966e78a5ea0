// Robust losses on vectors of residuals, as ident/robust_loss.hpp defines them: D is the tuning constant times sigma
// and t = r^2 / D^2. `cost` accumulates the objective up to a factor and an offset that are the window's own.
#if defined(MODEBANK_BATCH_LOSS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_BATCH_LOSS_INL
#undef MODEBANK_BATCH_LOSS_INL
#else
#define MODEBANK_BATCH_LOSS_INL
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "ident/batch_lanes-inl.hpp"
#include "ident/local_model.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::batch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// At one residual: psi = rho' r, slope = d psi / d r = rho' + 2 s rho'', weight = rho'.
struct LossTerms {
  V psi, slope, weight;
};

/// Every loss has `binary_slope` (slopes are 0 or 1), `terms(r)` and an accumulator `Cost`, whose value is sum rho in
/// units of r^2 up to an offset.
struct TrivialLoss {
  static constexpr bool quadratic = true, binary_slope = true;
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
  static constexpr bool quadratic = false, binary_slope = true;
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

struct SoftLOneLoss {
  static constexpr bool quadratic = false, binary_slope = false;
  V inverse_square, square;
  explicit SoftLOneLoss(V scale) : SoftLOneLoss(hn::Mul(scale, scale), hn::Div(splat(1.0), hn::Mul(scale, scale))) {}
  SoftLOneLoss(V scale_square, V inverse) : inverse_square(inverse), square(scale_square) {}
  HWY_INLINE LossTerms terms(V r) const {
    const V u = hn::MulAdd(hn::Mul(r, r), inverse_square, splat(1.0));
    const V w = reciprocal_root(u);
    return {hn::Mul(w, r), hn::Mul(w, hn::Mul(w, w)), w};
  }
  /// rho = 2 D^2 (sqrt(1 + t) - 1).
  struct Cost {
    V sum;
    HWY_INLINE Cost() : sum(zero()) {}
    HWY_INLINE void add(const SoftLOneLoss& loss, V r, const LossTerms& at_r) {
      const V u = hn::MulAdd(hn::Mul(r, r), loss.inverse_square, splat(1.0));
      sum = hn::MulAdd(u, at_r.weight, sum);
    }
    HWY_INLINE V value(const SoftLOneLoss& loss) const { return hn::Mul(hn::Add(loss.square, loss.square), sum); }
  };
};

struct CauchyLoss {
  static constexpr bool quadratic = false, binary_slope = false;
  V inverse_square, square;
  explicit CauchyLoss(V scale) : CauchyLoss(hn::Mul(scale, scale), hn::Div(splat(1.0), hn::Mul(scale, scale))) {}
  CauchyLoss(V scale_square, V inverse) : inverse_square(inverse), square(scale_square) {}
  HWY_INLINE LossTerms terms(V r) const {
    const V t = hn::Mul(hn::Mul(r, r), inverse_square);
    const V w = reciprocal(hn::Add(t, splat(1.0)));
    return {hn::Mul(w, r), hn::Mul(hn::Sub(splat(1.0), t), hn::Mul(w, w)), w};
  }
  /// rho = D^2 log(1 + t): the logarithm of a product, taken before it can overflow.
  struct Cost {
    static constexpr double largest = 1e37;
    static constexpr int factors = 8;
    V sum, product;
    int count = 0;
    HWY_INLINE Cost() : sum(zero()), product(splat(1.0)) {}
    HWY_INLINE void add(const CauchyLoss& loss, V r, const LossTerms&) {
      const V u = hn::MulAdd(hn::Mul(r, r), loss.inverse_square, splat(1.0));
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

struct TukeyLoss {
  static constexpr bool quadratic = false, binary_slope = false;
  V inverse_square, square;
  explicit TukeyLoss(V scale) : TukeyLoss(hn::Mul(scale, scale), hn::Div(splat(1.0), hn::Mul(scale, scale))) {}
  TukeyLoss(V scale_square, V inverse) : inverse_square(inverse), square(scale_square) {}
  HWY_INLINE LossTerms terms(V r) const {
    const V t = hn::Mul(hn::Mul(r, r), inverse_square);
    const V m = hn::Max(hn::Sub(splat(1.0), t), zero());
    const V w = hn::Mul(m, m);
    return {hn::Mul(w, r), hn::Mul(m, hn::NegMulAdd(splat(5.0), t, splat(1.0))), w};
  }
  /// rho = D^2 / 3 (1 - m^3).
  struct Cost {
    V sum;
    HWY_INLINE Cost() : sum(zero()) {}
    HWY_INLINE void add(const TukeyLoss& loss, V r, const LossTerms& at_r) {
      const V t = hn::Mul(hn::Mul(r, r), loss.inverse_square);
      const V m = hn::Max(hn::Sub(splat(1.0), t), zero());
      sum = hn::Add(sum, hn::NegMulAdd(at_r.weight, m, splat(1.0)));
    }
    HWY_INLINE V value(const TukeyLoss& loss) const { return hn::Mul(hn::Mul(loss.square, splat(1.0 / 3.0)), sum); }
  };
};

struct ArctanLoss {
  static constexpr bool quadratic = false, binary_slope = false;
  V inverse_square, square;
  explicit ArctanLoss(V scale) : ArctanLoss(hn::Mul(scale, scale), hn::Div(splat(1.0), hn::Mul(scale, scale))) {}
  ArctanLoss(V scale_square, V inverse) : inverse_square(inverse), square(scale_square) {}
  HWY_INLINE LossTerms terms(V r) const {
    const V t = hn::Mul(hn::Mul(r, r), inverse_square), t2 = hn::Mul(t, t);
    const V w = hn::Div(splat(1.0), hn::Add(splat(1.0), t2));
    return {hn::Mul(w, r), hn::Mul(hn::Mul(w, w), hn::NegMulAdd(splat(3.0), t2, splat(1.0))), w};
  }
  /// rho = D^2 atan(t).
  struct Cost {
    V sum;
    HWY_INLINE Cost() : sum(zero()) {}
    HWY_INLINE void add(const ArctanLoss& loss, V r, const LossTerms&) {
      sum = hn::Add(sum, hn::Atan(D(), hn::Mul(hn::Mul(r, r), loss.inverse_square)));
    }
    HWY_INLINE V value(const ArctanLoss& loss) const { return hn::Mul(loss.square, sum); }
  };
};

/// Any loss, chosen at run time; for shapes that are not worth a kernel per loss.
struct AnyLoss {
  static constexpr bool quadratic = false, binary_slope = false;
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
  template <class L>
  static HWY_INLINE V rho_of(const L& loss, V r, const LossTerms& at_r) {
    typename L::Cost cost;
    cost.add(loss, r, at_r);
    return cost.value(loss);
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
};

/// rho without the offset of the loss' Cost.
template <class LossT>
HWY_INLINE V cost_above_zero(const LossT& loss, V r, const LossTerms& at_r) {
  return hn::Sub(AnyLoss::rho_of(loss, r, at_r), AnyLoss::rho_of(loss, zero(), loss.terms(zero())));
}
HWY_INLINE V cost_above_zero(const AnyLoss& loss, V r, const LossTerms& at_r) {
  return hn::Sub(loss.rho(r, at_r), loss.rho(zero(), loss.terms(zero())));
}

}  // namespace modebank::batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
