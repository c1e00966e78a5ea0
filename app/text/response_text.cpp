#include "app/text/response_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "app/text/number_text.hpp"
#include "app/text/operating_point.hpp"
#include "io/archive/bank/units.hpp"

namespace modebank::app {
namespace {

using Eigen::Index;

struct Pair {
  Index state = 0, input = 0;
  double effect = 0.0;
};

/// All pairs of inputs that move, those that move most first.
std::vector<Pair> pairs_of(const Bank& single, const Recording& recording) {
  const Eigen::MatrixXd& gain = single.modes.front().response.value.gain;
  Spread inputs(recording.input_count());
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train) inputs.add(run.inputs());
  const Eigen::VectorXd deviation = inputs.deviation();
  std::vector<Pair> pairs;
  for (Index i = 0; i < gain.rows(); ++i)
    for (Index j = 0; j < gain.cols(); ++j)
      if (deviation(j) > 0.0)
        pairs.push_back({i, j, std::isfinite(gain(i, j)) ? std::abs(gain(i, j)) * deviation(j) : 0.0});
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.effect > b.effect; });
  return pairs;
}

/// " K/W"; empty where a unit is unknown, or both are equal.
std::string unit_of_gain(const Channel& state, const Channel& input) {
  const std::string unit = unit_ratio(state.unit, input.unit);
  return unit.empty() || unit == "1" ? "" : " " + unit;
}

/// Coefficients of 1, q^-1, ... in A(q) x = B(q) u, for one state and one input. A model of differences has a factor
/// 1 - q^-1 in both, which is divided out.
struct Polynomials {
  std::vector<double> A, B;
};

Polynomials polynomials(const Bank& single, Index input) {
  constexpr double rounding = 1e-9;
  const LinearStructure& s = single.structure;
  const LinearModel& model = single.modes.front().model;
  Polynomials of{{1.0, -1.0}, std::vector<double>(static_cast<std::size_t>(s.input_delay[input]), 0.0)};
  of.A.resize(static_cast<std::size_t>(s.state_lags) + 1);
  for (Index lag = 0; lag < s.state_lags; ++lag) of.A[static_cast<std::size_t>(lag) + 1] -= model.A(0, lag);
  double size = 0.0;
  for (Index lag = 0; lag < s.input_lags; ++lag) {
    of.B.push_back(model.B(0, lag * s.inputs + input));
    size += std::abs(of.B.back());
  }
  const auto sum = [](const std::vector<double>& a) { return std::accumulate(a.begin(), a.end(), 0.0); };
  if (std::abs(sum(of.A)) > rounding || std::abs(sum(of.B)) > rounding * size) return of;
  for (std::vector<double>* one : {&of.A, &of.B}) {
    std::partial_sum(one->begin(), one->end(), one->begin());
    one->pop_back();
  }
  return of;
}

/// The straight line that the response of one state follows, whose pole lies near 1, after the other poles have
/// settled: its slope, and the time at which it leaves zero.
struct Ramp {
  double per_s = std::nan(""), after_s = 0.0;  ///< NaN for several states
};

Ramp ramp(const Bank& single, Index input) {
  if (single.structure.states > 1) return {};
  const auto [A, B] = polynomials(single, input);
  double ends = 0.0, late = 0.0, first = 0.0, second = 0.0;  // B(1), B'(1), -A'(1), -A''(1), by q^-1
  for (std::size_t j = 0; j < B.size(); ++j) ends += B[j], late += static_cast<double>(j) * B[j];
  for (std::size_t j = 1; j < A.size(); ++j) {
    first -= static_cast<double>(j) * A[j];
    second -= static_cast<double>(j * (j - 1)) * A[j];
  }
  return {ends / first / single.dt_s, (late / ends - second / (2.0 * first) - 1.0) * single.dt_s};
}

/// Whether an error leaves a value to act on: at most a third of it. An unknown error (NaN) is no objection.
bool tells(double value, double error) { return std::isnan(error) || error <= std::abs(value) / 3.0; }

/// Whether an input moves by half of its range within a time, as a sine does from the frequency 1 / time on. Where it
/// does not, an overshoot is extrapolated: what undoes the smoothing of an input exceeds every jump, but none is
/// logged.
bool moves_within(const Recording& recording, Index input, double time_s) {
  const auto samples = std::max<Index>(1, std::lround(time_s / recording.median_period_s()));
  Spread all(1);
  double most = 0.0;
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train) continue;
    const Eigen::MatrixXd u = run.inputs().row(input);
    all.add(u);
    for (Index k = samples; k < u.cols(); ++k) most = std::max(most, std::abs(u(k) - u(k - samples)));
  }
  return most >= (all.high(0) - all.low(0)) / 2.0;
}

/// "63 % of 0.804 +- 0.003 K/W after 62.3 +- 0.3 s, within 5 % after 183 +- 1 s", without what its error drowns.
std::string settled_words(const EstimatedStepResponse& response, const Recording& recording, const Pair& pair,
                          const std::string& unit_of_gain, const std::string& unit) {
  const auto [i, j, effect] = pair;
  const auto& [value, error, share] = response;
  const double gain = value.gain(i, j), off = error.gain(i, j), time_s = value.response_s(i, j);
  if (!tells(gain, off)) return fmt::format("within +-{:.2g}{} in the end", std::abs(gain) + 2.0 * off, unit_of_gain);
  std::string text = estimate_text(gain, off) + unit_of_gain;
  if (!tells(time_s, error.response_s(i, j))) return text + " in the end";
  text = fmt::format("63 % of {} after {} {}", text, estimate_text(time_s, error.response_s(i, j)), unit);
  const double settling = value.settling_s(i, j), over = value.overshoot(i, j), over_off = error.overshoot(i, j);
  if (over > 0.05 && !moves_within(recording, j, time_s)) return text;
  if (std::isfinite(settling) && tells(settling, error.settling_s(i, j)))
    text += fmt::format(", within 5 % after {} {}", estimate_text(settling, error.settling_s(i, j)), unit);
  if (over > 0.05 && tells(over, over_off)) text += fmt::format(", overshoot {:.0f} %", 100.0 * over);
  return text;
}

std::string words_of(const Bank& single, const Recording& recording, const Pair& pair, const std::string& unit) {
  const EstimatedStepResponse& response = single.modes.front().response;
  const auto [i, j, effect] = pair;
  const Channel& state = recording.states[static_cast<std::size_t>(i)];
  const Channel& input = recording.inputs[static_cast<std::size_t>(j)];
  const double radius = response.value.radius(i, j), off = response.error.radius(i, j);
  const double share = response.never_settles(i, j);
  const double reach = std::isfinite(off) ? 2.0 * off : 0.0;
  const std::string name = fmt::format("{} per {}: ", state.name, input.name);
  const std::string never = share > 0.05 ? fmt::format(", {:.0f} % of the draws never settle", 100.0 * share) : "";
  if (radius + reach < 1.0 && !std::isinf(response.error.gain(i, j)))
    return name + settled_words(response, recording, pair, unit_of_gain(state, input), unit) + never;
  const double least = radius - reach;
  const std::string slower = least > 0.0 && least < 1.0
                                 ? fmt::format("settles slower than {:.2g} {}", -single.dt_s / std::log(least), unit)
                                 : std::string("does not settle within the runs");
  if (radius + reach < 1.0) return name + slower + never;
  const auto [slope, after_s] = ramp(single, j);
  std::string rate;
  if (std::isfinite(slope)) rate = fmt::format(" {:.3g}{} per {}", slope, unit_of_gain(state, input), unit);
  if (after_s > single.dt_s / 2.0) rate += fmt::format(" after {:.2g} {}", after_s, unit);
  return name + "integrates" + rate + ", or " + slower + never;
}

}  // namespace

std::vector<std::string> response_words(const Bank& single, const Recording& recording, const std::string& unit) {
  std::vector<std::string> words;
  for (const Pair& pair : pairs_of(single, recording)) words.push_back(words_of(single, recording, pair, unit));
  return words;
}

}  // namespace modebank::app
