// Fits a chunk of windows, one vector of windows at a time, and writes the results to memory.
#if defined(MODEBANK_BATCH_CHUNK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODEBANK_BATCH_CHUNK_INL
#undef MODEBANK_BATCH_CHUNK_INL
#else
#define MODEBANK_BATCH_CHUNK_INL
#endif

#include <hwy/highway.h>

#include <algorithm>

#include "ident/fit/detail/batch/kernel-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modebank::batch::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

inline constexpr Index widest = padding;

HWY_INLINE View contiguous_view(const Settings& settings, const Chunk& chunk, Index first) {
  View view{{}, chunk.increments + first, nullptr, 1, settings.length};
  for (int j = 0; j < settings.regressors; ++j) view.regressors[j] = chunk.regressors[j] + first;
  if (chunk.present) view.present = chunk.present + first;
  return view;
}

/// Copies windows that do not start one sample apart, one window per lane. Lanes beyond the last window repeat that
/// window.
HWY_INLINE View transposed_view(const Settings& settings, const Chunk& chunk, Index first, double* memory) {
  const Index lanes = static_cast<Index>(hn::Lanes(D()));
  const auto transpose = [&](const double* column) {
    double* const begin = memory;
    for (Index lane = 0; lane < lanes; ++lane) {
      const double* const window = column + std::min(first + lane, chunk.windows - 1) * settings.step;
      for (Index i = 0; i < settings.length; ++i) begin[i * lanes + lane] = window[i];
    }
    memory += settings.length * lanes;
    return static_cast<const double*>(begin);
  };
  View view{{}, transpose(chunk.increments), nullptr, lanes, settings.length};
  for (int j = 0; j < settings.regressors; ++j) view.regressors[j] = transpose(chunk.regressors[j]);
  if (chunk.present) view.present = transpose(chunk.present);
  return view;
}

HWY_INLINE void scatter(V value, Index count, double* out, Index stride) {
  if (!out) return;
  HWY_ALIGN double lane[widest];
  hn::Store(value, D(), lane);
  constexpr Index all = static_cast<Index>(hn::MaxLanes(D()));
  if (count == all) {
    for (Index i = 0; i < all; ++i) out[i * stride] = lane[i];
  } else {
    for (Index i = 0; i < count; ++i) out[i * stride] = lane[i];
  }
}

HWY_INLINE void scatter_flags(M mask, Index count, bool (&flag)[widest]) {
  HWY_ALIGN double lane[widest];
  hn::Store(hn::IfThenElseZero(mask, splat(1.0)), D(), lane);
  for (Index i = 0; i < count; ++i) flag[i] = lane[i] != 0.0;
}

/// Stores the integer results: verdict, rank and status.
template <int Q>
HWY_INLINE void write_verdicts(const Settings& settings, const Fit<Q>& fit, Index first, Index count,
                               const Output& out) {
  const M rated = settings.prior ? fit.reached : hn::AndNot(fit.deficient, fit.reached);
  const M solved = hn::And(hn::And(fit.enough, fit.clear), rated);
  const bool plain = hn::CountTrue(D(), hn::AndNot(fit.deficient, solved)) == hn::Lanes(D());
  // the usual case: all lanes are solved
  if (plain && count == static_cast<Index>(hn::Lanes(D())) && !out.transitions) {
    std::fill_n(out.verdict + first, count, Verdict::solved);
    if (out.rank) std::fill_n(out.rank + first, count, Q);
    if (out.status) std::fill_n(out.status + first, count, static_cast<int>(FitStatus::converged));
    return;
  }
  bool enough[widest], clear[widest], deficient[widest], reached[widest];
  scatter_flags(fit.enough, count, enough);
  scatter_flags(fit.clear, count, clear);
  scatter_flags(fit.deficient, count, deficient);
  scatter_flags(fit.reached, count, reached);
  HWY_ALIGN double rank[widest];
  hn::Store(fit.rank, D(), rank);
  HWY_ALIGN double samples[widest];
  hn::Store(fit.samples, D(), samples);
  for (Index i = 0; i < count; ++i) {
    Verdict verdict = Verdict::solved;
    if (!enough[i])
      verdict = Verdict::too_few_samples;
    else if (!clear[i])
      verdict = Verdict::ill_conditioned;
    else if (deficient[i] && !settings.prior)
      verdict = Verdict::rank_deficient;
    else if (!reached[i])
      verdict = Verdict::not_converged;
    out.verdict[first + i] = verdict;
    if (out.rank) out.rank[first + i] = clear[i] ? static_cast<int>(rank[i]) : 0;
    if (out.transitions) out.transitions[first + i] = static_cast<int>(samples[i]);
    if (out.status)
      out.status[first + i] = static_cast<int>(deficient[i] ? FitStatus::rank_deficient : FitStatus::converged);
  }
}

template <int Q>
HWY_NOINLINE void write(const Settings& settings, const Fit<Q>& fit, Index first, Index count, const Output& out) {
  const auto from = [](double* array, Index offset) { return array ? array + offset : nullptr; };
  write_verdicts(settings, fit, first, count, out);
  for (int j = 0; j < Q; ++j) scatter(fit.search.theta[j], count, from(out.theta, first * Q + j), Q);
  for (int i = 0; i < Q; ++i)
    for (int j = 0; j <= i; ++j) {
      scatter(fit.covariance.a[at(i, j)], count, from(out.covariance, first * Q * Q + i * Q + j), Q * Q);
      if (i != j) scatter(fit.covariance.a[at(i, j)], count, from(out.covariance, first * Q * Q + j * Q + i), Q * Q);
    }
  scatter(fit.noise_variance, count, from(out.noise_variance, first), 1);
  scatter(fit.condition, count, from(out.condition, first), 1);
  scatter(fit.inlier_fraction, count, from(out.inlier_fraction, first), 1);
  scatter(fit.r_squared, count, from(out.r_squared, first), 1);
  scatter(fit.weighed_information, count, from(out.weighed_information, first), 1);
  for (int j = 0; j < Q; ++j) scatter(fit.information[j], count, from(out.information, first * Q + j), Q);
}

template <int Q, class LossT, class FirstLoss>
HWY_NOINLINE void solve_chunk(const Settings& settings, const Chunk& chunk, double* scratch, const Output& out) {
  const Index lanes = static_cast<Index>(hn::Lanes(D()));
  double* const side_by_side = scratch + settings.length * lanes * (Q + 2);
  for (Index first = 0; first < chunk.windows; first += lanes) {
    const Index count = std::min(lanes, chunk.windows - first);
    const View view = settings.step == 1 ? contiguous_view(settings, chunk, first)
                                         : transposed_view(settings, chunk, first, side_by_side);
    Fit<Q> fit;
    fit_group<Q, LossT, FirstLoss>(settings, view, hn::FirstN(D(), static_cast<std::size_t>(count)), scratch, fit);
    write(settings, fit, first, count, out);
  }
}

}  // namespace modebank::batch::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
