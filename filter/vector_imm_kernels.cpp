// The steps of vector_imm.hpp, once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/vector_imm_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After highway.h:
#include <hwy/contrib/math/math-inl.h>

#include <cmath>

#include "filter/bounds.hpp"
#include "filter/vector_imm_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::vector_imm::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most the padding's width, so that rows are whole registers everywhere.
using D = hn::CappedTag<double, row_multiple>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

constexpr double log_two_pi = 1.8378770664093454836;
constexpr double far = 1e300;                         // the distance of an impossible mode
constexpr double relative_pivot_floor = 1e-14;        // as in small_matrix.hpp
constexpr double largest_standardised_square = 25.0;  // as in noise_scale.hpp

HWY_INLINE V splat(double value) { return hn::Set(D(), value); }
HWY_INLINE V load(const double* p) { return hn::Load(D(), p); }
HWY_INLINE void store(V v, double* p) { hn::Store(v, D(), p); }
HWY_INLINE double sum_of(V v) { return hn::GetLane(hn::SumOfLanes(D(), v)); }

constexpr std::size_t packed(std::size_t a, std::size_t b) {
  return a >= b ? a * (a + 1) / 2 + b : b * (b + 1) / 2 + a;
}
constexpr std::size_t packed_size(std::size_t n) { return n * (n + 1) / 2; }

/// Rows r .. r + lanes of a group of rows.
template <std::size_t Rows>
HWY_INLINE void load_rows(const double* p, std::size_t stride, V (&v)[Rows]) {
  for (std::size_t i = 0; i < Rows; ++i) v[i] = load(p + i * stride);
}
template <std::size_t Rows>
HWY_INLINE void store_rows(const V (&v)[Rows], std::size_t stride, double* p) {
  for (std::size_t i = 0; i < Rows; ++i) store(v[i], p + i * stride);
}

/// Mean and covariance of as many modes as a register has lanes.
template <std::size_t N>
struct Moments {
  V x[N];
  V P[packed_size(N)];
};

/// Where the modes r .. start from: the mixture of all modes that lead to them (Blom & Bar-Shalom 1988).
template <std::size_t N>
HWY_INLINE Moments<N> mix(const ModeRows& p, std::size_t r) {
  const std::size_t stride = p.stride;
  Moments<N> m;
  V c = hn::Zero(D());
  for (V& x : m.x) x = hn::Zero(D());
  for (V& P : m.P) P = hn::Zero(D());
  for (std::size_t i = 0; i < p.modes; ++i) {
    const V w = hn::Mul(load(p.transition + i * stride + r), splat(p.probability[i]));
    c = hn::Add(c, w);
    for (std::size_t a = 0; a < N; ++a) m.x[a] = hn::MulAdd(w, splat(p.mean[a * stride + i]), m.x[a]);
  }
  const M possible = hn::Ge(c, splat(impossible_probability));
  const V inverse = hn::Div(splat(1.0), hn::IfThenElse(possible, c, splat(1.0)));
  for (std::size_t a = 0; a < N; ++a)
    m.x[a] = hn::IfThenElse(possible, hn::Mul(m.x[a], inverse), load(p.mean + a * stride + r));
  for (std::size_t i = 0; i < p.modes; ++i) {
    const V w = hn::Mul(load(p.transition + i * stride + r), splat(p.probability[i]));
    V d[N];
    for (std::size_t a = 0; a < N; ++a) d[a] = hn::Sub(splat(p.mean[a * stride + i]), m.x[a]);
    for (std::size_t a = 0; a < N; ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        const std::size_t k = packed(a, b);
        m.P[k] = hn::MulAdd(w, hn::MulAdd(d[a], d[b], splat(p.covariance[k * stride + i])), m.P[k]);
      }
  }
  for (std::size_t k = 0; k < packed_size(N); ++k)
    m.P[k] = hn::IfThenElse(possible, hn::Mul(m.P[k], inverse), load(p.covariance + k * stride + r));
  store(c, p.predicted_probability + r);
  return m;
}

/// Keeps a prediction usable, as make_usable of kalman.hpp does.
template <std::size_t N>
HWY_INLINE void make_usable(Moments<N>& m) {
  V largest = m.P[0], least = m.P[0], mean = hn::Abs(m.x[0]);
  for (std::size_t a = 1; a < N; ++a) {
    largest = hn::Max(largest, m.P[packed(a, a)]);
    least = hn::Min(least, m.P[packed(a, a)]);
    mean = hn::Max(mean, hn::Abs(m.x[a]));
  }
  const M negative = hn::Lt(least, hn::Zero(D()));
  const M odd = hn::Or(negative, hn::Or(hn::Gt(largest, splat(largest_variance)), hn::Gt(mean, splat(largest_mean))));
  if (HWY_LIKELY(hn::AllFalse(D(), odd))) return;
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      V& P = m.P[packed(a, b)];
      P = hn::IfThenElse(negative, a == b ? hn::Abs(P) : hn::Zero(D()), P);
    }
  largest = hn::Max(largest, hn::Neg(least));
  const V shrink = hn::Div(splat(largest_variance), hn::Max(largest, splat(largest_variance)));
  for (V& P : m.P) P = hn::Mul(P, shrink);
  const V pull = hn::Div(splat(largest_mean), hn::Max(mean, splat(largest_mean)));
  for (V& x : m.x) x = hn::Mul(x, pull);
}

template <std::size_t N>
void predict(const ModeRows& p, const double* v, double noise_scale) {
  const std::size_t stride = p.stride;
  const V scale = splat(noise_scale);
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    const Moments<N> from = mix<N>(p, r);
    V F[N * N];
    load_rows(p.F + r, stride, F);
    Moments<N> m;
    for (std::size_t a = 0; a < N; ++a) {
      V x = load(p.c + a * stride + r);
      for (std::size_t i = 0; i < p.inputs; ++i)
        x = hn::MulAdd(load(p.B + (a * p.inputs + i) * stride + r), splat(v[i]), x);
      for (std::size_t b = 0; b < N; ++b) x = hn::MulAdd(F[a * N + b], from.x[b], x);
      m.x[a] = x;
    }
    for (std::size_t a = 0; a < N; ++a) {
      V row[N];  // of F P
      for (std::size_t b = 0; b < N; ++b) {
        row[b] = hn::Mul(F[a * N], from.P[packed(0, b)]);
        for (std::size_t k = 1; k < N; ++k) row[b] = hn::MulAdd(F[a * N + k], from.P[packed(k, b)], row[b]);
      }
      for (std::size_t b = 0; b <= a; ++b) {
        V sum = hn::Mul(scale, load(p.Q + packed(a, b) * stride + r));
        for (std::size_t k = 0; k < N; ++k) sum = hn::MulAdd(row[k], F[b * N + k], sum);
        m.P[packed(a, b)] = sum;
      }
    }
    make_usable(m);
    store_rows(m.x, stride, p.predicted_mean + r);
    store_rows(m.P, stride, p.predicted_covariance + r);
  }
}

/// P C' of a covariance.
template <std::size_t N, std::size_t NY>
HWY_INLINE void times_sensor(const V (&P)[packed_size(N)], const double* C, V (&PCt)[N * NY]) {
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t i = 0; i < NY; ++i) {
      V sum = hn::Mul(P[packed(a, 0)], splat(C[i * N]));
      for (std::size_t b = 1; b < N; ++b) sum = hn::MulAdd(P[packed(a, b)], splat(C[i * N + b]), sum);
      PCt[a * NY + i] = sum;
    }
}

template <std::size_t N, std::size_t NY>
void expect(const ModeRows& p, const Sensor& sensor) {
  const std::size_t stride = p.stride;
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    V x[N], P[packed_size(N)], PCt[N * NY], S[packed_size(NY)], L[packed_size(NY)], pivot[NY], inverse[NY];
    load_rows(p.predicted_mean + r, stride, x);
    load_rows(p.predicted_covariance + r, stride, P);
    times_sensor<N, NY>(P, sensor.C, PCt);
    for (std::size_t i = 0; i < NY; ++i) {
      V y = hn::Zero(D());
      for (std::size_t a = 0; a < N; ++a) y = hn::MulAdd(splat(sensor.C[i * N + a]), x[a], y);
      store(y, p.expected + i * stride + r);
      for (std::size_t k = 0; k <= i; ++k) {
        V sum = splat(sensor.R[i * NY + k]);
        for (std::size_t a = 0; a < N; ++a) sum = hn::MulAdd(splat(sensor.C[i * N + a]), PCt[a * NY + k], sum);
        S[packed(i, k)] = sum;
      }
    }
    for (std::size_t j = 0; j < NY; ++j) {
      V d = S[packed(j, j)];
      for (std::size_t k = 0; k < j; ++k) {
        const V l = L[packed(j, k)];
        d = hn::NegMulAdd(hn::Mul(l, l), pivot[k], d);
      }
      const V floor = hn::Max(hn::Mul(splat(relative_pivot_floor), hn::Abs(S[packed(j, j)])), splat(least_variance));
      pivot[j] = hn::Max(d, floor);
      inverse[j] = hn::Div(splat(1.0), pivot[j]);
      L[packed(j, j)] = splat(1.0);
      for (std::size_t i = j + 1; i < NY; ++i) {
        V sum = S[packed(i, j)];
        for (std::size_t k = 0; k < j; ++k)
          sum = hn::NegMulAdd(hn::Mul(L[packed(i, k)], L[packed(j, k)]), pivot[k], sum);
        L[packed(i, j)] = hn::Mul(sum, inverse[j]);
      }
    }
    store_rows(S, stride, p.innovation_covariance + r);
    store_rows(L, stride, p.L + r);
    store_rows(pivot, stride, p.D + r);
    store_rows(inverse, stride, p.D_inverse + r);
  }
}

/// v := L^-1 v, and v := S^-1 v.
template <std::size_t NY>
HWY_INLINE void decorrelate(const V (&L)[packed_size(NY)], V (&v)[NY]) {
  for (std::size_t i = 1; i < NY; ++i)
    for (std::size_t k = 0; k < i; ++k) v[i] = hn::NegMulAdd(L[packed(i, k)], v[k], v[i]);
}
template <std::size_t NY>
HWY_INLINE void solve(const V (&L)[packed_size(NY)], const V (&inverse)[NY], V (&v)[NY]) {
  decorrelate<NY>(L, v);
  for (std::size_t i = NY; i-- > 0;) {
    v[i] = hn::Mul(v[i], inverse[i]);
    for (std::size_t k = i + 1; k < NY; ++k) v[i] = hn::NegMulAdd(L[packed(k, i)], v[k], v[i]);
  }
}

/// One register of modes taking a measurement in.
template <std::size_t N, std::size_t NY>
struct Correction {
  V L[packed_size(NY)], inverse[NY], e[NY], z[NY];
  Moments<N> m;  // predicted

  HWY_INLINE Correction(const ModeRows& p, const double* y, std::size_t r) {
    load_rows(p.L + r, p.stride, L);
    load_rows(p.D_inverse + r, p.stride, inverse);
    load_rows(p.predicted_mean + r, p.stride, m.x);
    load_rows(p.predicted_covariance + r, p.stride, m.P);
    for (std::size_t i = 0; i < NY; ++i) e[i] = z[i] = hn::Sub(splat(y[i]), load(p.expected + i * p.stride + r));
    decorrelate<NY>(L, z);
  }

  HWY_INLINE V distance() const {
    V sum = hn::Mul(hn::Mul(z[0], z[0]), inverse[0]);
    for (std::size_t i = 1; i < NY; ++i) sum = hn::MulAdd(hn::Mul(z[i], z[i]), inverse[i], sum);
    return sum;
  }
  HWY_INLINE V root_determinant_inverse() const {
    V product = inverse[0];
    for (std::size_t i = 1; i < NY; ++i) product = hn::Mul(product, inverse[i]);
    return hn::Sqrt(product);
  }

  /// Joseph's form; an overflowing correction is no information.
  HWY_INLINE Moments<N> posterior(const Sensor& sensor) const {
    V PCt[N * NY], gain[N][NY], closed[N * N], product[N], gainR[NY];
    times_sensor<N, NY>(m.P, sensor.C, PCt);
    for (std::size_t a = 0; a < N; ++a) {
      for (std::size_t i = 0; i < NY; ++i) gain[a][i] = PCt[a * NY + i];
      solve<NY>(L, inverse, gain[a]);
    }
    Moments<N> result;
    V check = hn::Zero(D());
    for (std::size_t a = 0; a < N; ++a) {
      result.x[a] = m.x[a];
      for (std::size_t i = 0; i < NY; ++i) result.x[a] = hn::MulAdd(gain[a][i], e[i], result.x[a]);
      check = hn::Add(check, result.x[a]);
      for (std::size_t b = 0; b < N; ++b) {
        V sum = splat(a == b ? 1.0 : 0.0);
        for (std::size_t i = 0; i < NY; ++i) sum = hn::NegMulAdd(gain[a][i], splat(sensor.C[i * N + b]), sum);
        closed[a * N + b] = sum;
      }
    }
    for (std::size_t a = 0; a < N; ++a) {
      for (std::size_t b = 0; b < N; ++b) {
        product[b] = hn::Mul(closed[a * N], m.P[packed(0, b)]);
        for (std::size_t k = 1; k < N; ++k) product[b] = hn::MulAdd(closed[a * N + k], m.P[packed(k, b)], product[b]);
      }
      for (std::size_t k = 0; k < NY; ++k) {
        gainR[k] = hn::Mul(gain[a][0], splat(sensor.R[k]));
        for (std::size_t i = 1; i < NY; ++i) gainR[k] = hn::MulAdd(gain[a][i], splat(sensor.R[i * NY + k]), gainR[k]);
      }
      for (std::size_t b = 0; b <= a; ++b) {
        V sum = hn::Mul(gainR[0], gain[b][0]);
        for (std::size_t i = 1; i < NY; ++i) sum = hn::MulAdd(gainR[i], gain[b][i], sum);
        for (std::size_t k = 0; k < N; ++k) sum = hn::MulAdd(product[k], closed[b * N + k], sum);
        result.P[packed(a, b)] = sum;
        check = hn::Add(check, sum);
      }
    }
    const M sound = hn::Lt(hn::Abs(check), splat(far));
    if (HWY_LIKELY(hn::AllTrue(D(), sound))) return result;
    for (std::size_t a = 0; a < N; ++a) result.x[a] = hn::IfThenElse(sound, result.x[a], m.x[a]);
    for (std::size_t k = 0; k < packed_size(N); ++k) result.P[k] = hn::IfThenElse(sound, result.P[k], m.P[k]);
    return result;
  }
};

/// tr(S^-1 C s Q C') and e' S^-1 C s Q C' S^-1 e of the modes r .., the latter with e' S^-1 e cut (noise_scale.hpp).
template <std::size_t N, std::size_t NY>
HWY_INLINE void explained(const ModeRows& p, const Sensor& sensor, const double* y, std::size_t r, V& share,
                          V& square) {
  const Correction<N, NY> c(p, y, r);
  V Q[packed_size(N)], QCt[N * NY];
  load_rows(p.Q + r, p.stride, Q);
  times_sensor<N, NY>(Q, sensor.C, QCt);
  V CQC[NY][NY];
  for (std::size_t i = 0; i < NY; ++i)
    for (std::size_t k = 0; k < NY; ++k) {
      V sum = hn::Mul(splat(sensor.C[k * N]), QCt[i]);
      for (std::size_t a = 1; a < N; ++a) sum = hn::MulAdd(splat(sensor.C[k * N + a]), QCt[a * NY + i], sum);
      CQC[i][k] = sum;  // column i of C Q C'
    }
  V pulled[NY];
  for (std::size_t i = 0; i < NY; ++i) pulled[i] = c.e[i];
  solve<NY>(c.L, c.inverse, pulled);
  share = square = hn::Zero(D());
  for (std::size_t i = 0; i < NY; ++i) {
    V along = hn::Zero(D());
    for (std::size_t k = 0; k < NY; ++k) along = hn::MulAdd(CQC[i][k], pulled[k], along);
    square = hn::MulAdd(along, pulled[i], square);
    solve<NY>(c.L, c.inverse, CQC[i]);
    share = hn::Add(share, CQC[i][i]);
  }
  const V most = splat(largest_standardised_square * static_cast<double>(NY)), nis = c.distance();
  square = hn::IfThenElse(hn::Gt(nis, most), hn::Mul(square, hn::Div(most, hn::Max(nis, most))), square);
}

/// Probabilities after the measurement: no mode dies for good.
HWY_INLINE void floor_probabilities(const ModeRows& p, const double* weights, double scale) {
  V total = hn::Zero(D());
  for (std::size_t r = 0; r < p.stride; r += hn::Lanes(D())) {
    const M there = hn::FirstN(D(), p.modes > r ? p.modes - r : 0);
    const V mu = hn::Max(hn::Mul(load(weights + r), splat(scale)), splat(mode_probability_floor));
    const V kept = hn::IfThenElseZero(there, mu);
    total = hn::Add(total, kept);
    store(kept, p.probability + r);
  }
  const V normal = splat(1.0 / sum_of(total));
  for (std::size_t r = 0; r < p.stride; r += hn::Lanes(D()))
    store(hn::Mul(load(p.probability + r), normal), p.probability + r);
}

template <std::size_t N, std::size_t NY>
UpdateResult update(const ModeRows& p, const Sensor& sensor, const double* y, double noise_scale) {
  const std::size_t stride = p.stride;
  V nearest = splat(far);
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    const Correction<N, NY> c(p, y, r);
    const V prior = load(p.predicted_probability + r);
    const M possible = hn::Ge(prior, splat(impossible_probability));
    const V distance = hn::IfThenElse(possible, c.distance(), splat(far));
    nearest = hn::Min(nearest, distance);
    store_rows(c.z, stride, p.decorrelated + r);
    store(distance, p.distance + r);
    store(hn::IfThenElseZero(possible, hn::Mul(prior, c.root_determinant_inverse())), p.weight + r);
    const Moments<N> posterior = c.posterior(sensor);
    store_rows(posterior.x, stride, p.mean + r);
    store_rows(posterior.P, stride, p.covariance + r);
  }
  nearest = hn::MinOfLanes(D(), nearest);
  V sum = hn::Zero(D()), share = sum, square = sum;
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    const V exponent = hn::Mul(splat(-0.5), hn::Sub(load(p.distance + r), nearest));
    const V w = hn::Mul(load(p.weight + r), hn::Exp(D(), exponent));
    store(w, p.weight + r);
    sum = hn::Add(sum, w);
    if (noise_scale > 0.0) {
      V share_r, square_r;
      explained<N, NY>(p, sensor, y, r, share_r, square_r);
      share = hn::MulAdd(w, share_r, share);
      square = hn::MulAdd(w, square_r, square);
    }
  }
  const double total = sum_of(sum);
  UpdateResult result;
  result.log_density = std::log(total) - 0.5 * (static_cast<double>(NY) * log_two_pi + hn::GetLane(nearest));
  if (noise_scale > 0.0) {
    result.share = noise_scale * sum_of(share) / total;
    result.square = noise_scale * sum_of(square) / total;
  }
  floor_probabilities(p, p.weight, 1.0 / total);
  return result;
}

template <std::size_t N>
void skip(const ModeRows& p) {
  for (std::size_t i = 0; i < N * p.stride; ++i) p.mean[i] = p.predicted_mean[i];
  for (std::size_t i = 0; i < packed_size(N) * p.stride; ++i) p.covariance[i] = p.predicted_covariance[i];
  floor_probabilities(p, p.predicted_probability, 1.0);
}

template <std::size_t N>
void merge(const ModeRows& p, CombinedMoments to) {
  const std::size_t stride = p.stride;
  V x[N], P[packed_size(N)];
  for (std::size_t a = 0; a < N; ++a) {
    V sum = hn::Zero(D());
    for (std::size_t r = 0; r < stride; r += hn::Lanes(D()))
      sum = hn::MulAdd(load(p.probability + r), load(p.mean + a * stride + r), sum);
    x[a] = hn::SumOfLanes(D(), sum);
    to.mean[a] = hn::GetLane(x[a]);
  }
  for (V& sum : P) sum = hn::Zero(D());
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    const V mu = load(p.probability + r);
    V d[N];
    for (std::size_t a = 0; a < N; ++a) d[a] = hn::Sub(load(p.mean + a * stride + r), x[a]);
    for (std::size_t a = 0; a < N; ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        const std::size_t k = packed(a, b);
        P[k] = hn::MulAdd(mu, hn::MulAdd(d[a], d[b], load(p.covariance + k * stride + r)), P[k]);
      }
  }
  for (std::size_t k = 0; k < packed_size(N); ++k) to.covariance[k] = sum_of(P[k]);
}

template <std::size_t N, std::size_t NY>
void combine(const ModeRows& p, const Sensor& sensor, CombinedExpectation& to) {
  const std::size_t stride = p.stride;
  for (std::size_t a = 0; a < N; ++a) {
    V sum = hn::Zero(D());
    for (std::size_t r = 0; r < stride; r += hn::Lanes(D()))
      sum = hn::MulAdd(load(p.predicted_probability + r), load(p.predicted_mean + a * stride + r), sum);
    to.state[a] = sum_of(sum);
  }
  V S[packed_size(NY)], spread = hn::Zero(D());
  for (V& sum : S) sum = hn::Zero(D());
  for (std::size_t r = 0; r < stride; r += hn::Lanes(D())) {
    const V c = load(p.predicted_probability + r);
    V d[NY];
    for (std::size_t i = 0; i < NY; ++i) {
      d[i] = hn::Zero(D());
      for (std::size_t a = 0; a < N; ++a)
        d[i] = hn::MulAdd(splat(sensor.C[i * N + a]),
                          hn::Sub(load(p.predicted_mean + a * stride + r), splat(to.state[a])), d[i]);
      spread = hn::MulAdd(c, hn::Mul(d[i], d[i]), spread);
    }
    for (std::size_t i = 0; i < NY; ++i)
      for (std::size_t k = 0; k <= i; ++k) {
        const V own = load(p.innovation_covariance + packed(i, k) * stride + r);
        S[packed(i, k)] = hn::MulAdd(c, hn::MulAdd(d[i], d[k], own), S[packed(i, k)]);
      }
  }
  for (std::size_t k = 0; k < packed_size(NY); ++k) to.innovation_covariance[k] = sum_of(S[k]);
  to.spread = sum_of(spread);
}

template <std::size_t N, std::size_t NY>
Kernels kernels_of() {
  return {predict<N>, expect<N, NY>, update<N, NY>, skip<N>, merge<N>, combine<N, NY>};
}

Kernels kernels_here(std::size_t n, std::size_t n_y) {
  if (n == 1 && n_y == 1) return kernels_of<1, 1>();
  if (n == 2 && n_y == 1) return kernels_of<2, 1>();
  if (n == 2 && n_y == 2) return kernels_of<2, 2>();
  if (n == 3 && n_y == 1) return kernels_of<3, 1>();
  if (n == 3 && n_y == 3) return kernels_of<3, 3>();
  if (n == 4 && n_y == 1) return kernels_of<4, 1>();
  return {};
}

}  // namespace modebank::vector_imm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modebank::vector_imm {

HWY_EXPORT(kernels_here);

Kernels kernels(std::size_t states, std::size_t measurements) {
  return HWY_DYNAMIC_DISPATCH(kernels_here)(states, measurements);
}

}  // namespace modebank::vector_imm
#endif
