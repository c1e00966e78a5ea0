#include "ident/check/stream_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/fit/scale.hpp"

namespace modebank {

namespace {

using Eigen::VectorXd;

std::vector<double> finite_values(const VectorXd& values) {
  std::vector<double> kept;
  std::copy_if(values.begin(), values.end(), std::back_inserter(kept), [](double v) { return std::isfinite(v); });
  return kept;
}

void check_intervals(const VectorXd& time_s, SamplingCheck& check) {
  const double period_s = median_period_s(time_s);
  if (!(period_s > 0.0)) return;
  check.rate_hz = 1.0 / period_s;
  check.jitter = step_scatter({&time_s});
  for (Index k = 1; k < time_s.size(); ++k) {
    const double interval = time_s(k) - time_s(k - 1);
    if (interval > gap_periods * period_s) {
      ++check.gaps;
      check.longest_gap_s = std::max(check.longest_gap_s, interval);
    }
  }
}

/// Whether all levels lie on a lattice with a spacing near `spacing`. The spacing is refined from level to level.
bool on_lattice(const std::vector<double>& levels, double& spacing) {
  constexpr double tolerance = 0.1, allowed_misses = 0.01;
  double products = 0.0, squares = 0.0;
  std::size_t misses = 0;
  for (const double level : levels) {
    const double height = level - levels.front(), steps = std::round(height / spacing);
    if (steps == 0.0) continue;
    if (std::abs(height / spacing - steps) > tolerance) {
      ++misses;
      continue;
    }
    products += steps * height;
    squares += steps * steps;
    spacing = products / squares;
  }
  return static_cast<double>(misses) <= allowed_misses * static_cast<double>(levels.size()) && squares > 0.0;
}

/// Largest spacing of a lattice that contains all levels (in increasing order); 0 if no lattice contains them.
double quantum_of(const std::vector<double>& levels) {
  constexpr double visible = 1e-3;  // smallest visible spacing, as a share of the range
  constexpr int most_divisions = 6;
  const double range = levels.back() - levels.front();
  double closest = range;
  for (std::size_t i = 1; i < levels.size(); ++i) closest = std::min(closest, levels[i] - levels[i - 1]);
  if (levels.size() < 3 || closest < visible * range) return 0.0;
  for (int part = 1; part <= most_divisions; ++part) {
    double spacing = closest / part;
    if (spacing >= visible * range && on_lattice(levels, spacing)) return spacing;
  }
  return 0.0;
}

/// Distinct values in increasing order. Values that differ only by rounding in the file count as one value.
std::vector<double> levels_of(std::vector<double> values) {
  // rounding: a share of the range; ulps: a share of the values, which may be far from zero (stamps)
  constexpr double rounding = 1e-9, ulps = 4.0;
  std::sort(values.begin(), values.end());
  const double largest = std::max(std::abs(values.front()), std::abs(values.back()));
  const double same =
      std::max(rounding * (values.back() - values.front()), ulps * std::numeric_limits<double>::epsilon() * largest);
  std::vector<double> levels;
  for (const double value : values)
    if (levels.empty() || value - levels.back() > same) levels.push_back(value);
  return levels;
}

/// Whether a signal takes few levels, and takes the ends of its range as often as the levels inside. An operator chose
/// such values; they are no sign of a limiter.
bool is_of_few_levels(const std::vector<double>& known) {
  constexpr std::size_t most_levels = 10;
  constexpr double pressed = 3.0;
  const std::vector<double> levels = levels_of(known);
  if (levels.size() > most_levels || levels.size() < 3) return levels.size() == 2;
  std::vector<double> shares(levels.size(), 0.0);
  for (const double value : known) {
    const auto above = std::upper_bound(levels.begin(), levels.end(), value);
    shares[static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - levels.begin() - 1, 0))] += 1.0;
  }
  const double inside = *std::max_element(shares.begin() + 1, shares.end() - 1);
  return std::max(shares.front(), shares.back()) <= pressed * inside;
}

}  // namespace

SamplingCheck check_sampling(const Stream& recorded) {
  SamplingCheck check;
  const VectorXd& time_s = recorded.time_s;
  check.samples = time_s.size();
  double latest = -std::numeric_limits<double>::infinity();
  Index repeats = 0;
  for (Index k = 0; k < time_s.size(); ++k) {
    if (!recorded.values.col(k).allFinite()) ++check.missing_samples;
    if (k > 0 && recorded.values.col(k) == recorded.values.col(k - 1)) ++repeats;
    if (!std::isfinite(time_s(k))) {
      ++check.missing_times;
      continue;
    }
    if (time_s(k) == latest) ++check.repeated_times;
    if (time_s(k) < latest) ++check.backward_times;
    latest = std::max(latest, time_s(k));
  }
  if (check.samples > 1) check.repeated_samples = static_cast<double>(repeats) / static_cast<double>(check.samples - 1);
  const Stream ordered = in_order(recorded);
  if (ordered.time_s.size() > 1) check.duration_s = ordered.time_s(ordered.time_s.size() - 1) - ordered.time_s(0);
  check_intervals(ordered.time_s, check);
  return check;
}

Stream in_order(const Stream& recorded) {
  const VectorXd& time_s = recorded.time_s;
  std::vector<Index> order(static_cast<std::size_t>(time_s.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::erase_if(order, [&](Index k) { return !std::isfinite(time_s(k)); });
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return time_s(a) < time_s(b); });
  order.erase(std::unique(order.begin(), order.end(), [&](Index a, Index b) { return time_s(a) == time_s(b); }),
              order.end());
  return {time_s(order), recorded.values(Eigen::all, order)};
}

ChannelCheck check_channel(const VectorXd& values) {
  ChannelCheck check;
  const std::vector<double> known = finite_values(values);
  check.missing = values.size() - static_cast<Index>(known.size());
  if (known.empty()) return check;
  const auto known_values = Eigen::Map<const VectorXd>(known.data(), static_cast<Index>(known.size()));
  check.least = known_values.minCoeff();
  check.largest = known_values.maxCoeff();
  check.mean = known_values.mean();
  check.sd = std::sqrt((known_values.array() - check.mean).square().mean());
  const std::vector<double> levels = levels_of(known);
  check.levels = static_cast<Index>(levels.size());
  check.quantum = quantum_of(levels);
  Index repeats = 0;
  for (Index k = 1; k < known_values.size(); ++k)
    if (known_values(k) == known_values(k - 1)) ++repeats;
  if (known.size() > 1) check.repeated = static_cast<double>(repeats) / static_cast<double>(known.size() - 1);
  check.two_level = has_two_levels(known_values);
  // A two-level signal may be on for a single sample, which is not an outlier.
  check.outliers = check.two_level ? 0 : spikes(known_values, check.quantum);
  return check;
}

bool has_two_levels(const VectorXd& values) {
  constexpr double near = 0.1, least_near = 0.99, least_share = 0.02;
  std::vector<double> known = finite_values(values);
  if (known.empty()) return false;
  // Quantiles are used so that a glitch does not count as a level.
  const auto quantile = [&known](double share) {
    const auto at = known.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(known.size() - 1));
    std::nth_element(known.begin(), at, known.end());
    return *at;
  };
  const double least = quantile(0.5 * least_share), middle = 0.5 * (least + quantile(1.0 - 0.5 * least_share));
  double low = 0.0, high = 0.0, count = 0.0, above = 0.0;
  for (const double value : known) {
    (value > middle ? high : low) += value;
    above += value > middle ? 1.0 : 0.0;
    count += 1.0;
  }
  if (!(std::min(above, count - above) >= least_share * count)) return false;
  high /= above;
  low /= count - above;
  const auto close = std::count_if(known.begin(), known.end(), [&](double value) {
    return std::abs(value - (value > middle ? high : low)) <= near * (high - low);
  });
  return high > low && static_cast<double>(close) >= least_near * count;
}

Index spikes(const VectorXd& values, double quantum) {
  constexpr Index reach = 25;
  constexpr double far = 12.0, quanta = 3.0, share_of_range = 0.01, median_of_normal = 0.674489750196081743;
  const Index N = values.size();
  if (N < 2 * reach) return 0;
  const double least = std::max(quanta * quantum, share_of_range * (values.maxCoeff() - values.minCoeff()));
  VectorXd distance = VectorXd::Zero(N);
  for (Index k = 1; k + 1 < N; ++k) distance(k) = std::abs(values(k) - 0.5 * (values(k - 1) + values(k + 1)));
  Index count = 0;
  for (Index k = 1; k + 1 < N; ++k) {
    const double before = values(k) - values(k - 1), after = values(k) - values(k + 1);
    const bool alone = before * after > 0.0 && std::min(std::abs(before), std::abs(after)) > 0.5 * distance(k);
    if (distance(k) <= least || !alone) continue;
    const Index first = std::clamp<Index>(k - reach, 0, N - 2 * reach);
    if (distance(k) > far / median_of_normal * median(distance.segment(first, 2 * reach))) ++count;
  }
  return count;
}

namespace {

/// Thresholds for an accumulation of values at an end of the range.
struct PileUp {
  double least_share;  ///< smallest share of all values that may count as an accumulation
  double ratio;        ///< smallest ratio to the number of neighbouring values
  double errors;       ///< number of standard errors by which the ratio must be exceeded
};

/// Values that are repeated for `held` samples on average. The `held` repetitions count as one independent value.
struct Held {
  std::vector<double> values;
  double held = 1.0;
};

/// Whether more values v lie in end - outer < sign * v <= end than in the range of width `next` below it.
bool piles_up(const Held& of, double sign, double end, double outer, double next, const PileUp& least) {
  const std::vector<double>& values = of.values;
  const auto between = [&](double from, double to) {
    return static_cast<double>(
        std::count_if(values.begin(), values.end(), [&](double v) { return sign * v > from && sign * v <= to; }));
  };
  const double top = between(end - outer, end), below = between(end - outer - next, end - outer);
  return top > least.least_share * static_cast<double>(values.size()) &&
         top - least.ratio * below > least.errors * std::sqrt(of.held * (top + least.ratio * least.ratio * below));
}

/// Appends all values of a run to `all`, and the values that differ from their predecessor to `fresh`.
void gather(const VectorXd& run, std::vector<double>& all, std::vector<double>& fresh) {
  const std::vector<double> known = finite_values(run);
  all.insert(all.end(), known.begin(), known.end());
  std::unique_copy(known.begin(), known.end(), std::back_inserter(fresh));
}

}  // namespace

SaturationLimits saturation_limits(const std::vector<VectorXd>& runs) {
  constexpr double band = 0.02, full = 0.8, fifth = 0.2;
  constexpr PileUp hard{0.005, 1.5, 3.0}, soft{0.02, 1.2, 3.0};
  Held samples, fresh;
  for (const VectorXd& run : runs) gather(run, samples.values, fresh.values);
  const std::vector<double>& all = samples.values;
  if (!all.empty()) samples.held = static_cast<double>(all.size()) / static_cast<double>(fresh.values.size());
  SaturationLimits limits{not_a_number, not_a_number, false};
  if (all.empty() || is_of_few_levels(all) || has_two_levels(VectorXd::Map(all.data(), std::ssize(all)))) return limits;
  const auto [least, largest] = std::minmax_element(all.begin(), all.end());
  const double low = *least, high = *largest, width = band * (high - low), scale = std::max(-low, high);
  if (!(width > 0.0)) return limits;
  const bool reaches_low = -low >= full * scale, reaches_high = high >= full * scale;
  if (reaches_low && piles_up(samples, -1.0, -low, width, 2.0 * width, hard)) limits.low = low + width;
  if (reaches_high && piles_up(samples, 1.0, high, width, 2.0 * width, hard)) limits.high = high - width;
  if (std::isfinite(limits.low) || std::isfinite(limits.high)) return limits;
  const double outer = fifth * scale;
  if (reaches_low && piles_up(fresh, -1.0, -low, outer, outer, soft)) limits.low = low + 0.5 * outer;
  if (reaches_high && piles_up(fresh, 1.0, high, outer, outer, soft)) limits.high = high - 0.5 * outer;
  limits.soft = std::isfinite(limits.low) || std::isfinite(limits.high);
  return limits;
}

}  // namespace modebank
