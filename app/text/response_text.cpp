#include "app/text/response_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/text/number_text.hpp"

namespace modebank::app {
namespace {

using Eigen::Index;

/// Standard deviation of each input over the training runs.
Eigen::VectorXd deviation_of_inputs(const Recording& recording) {
  const Index m = recording.input_count();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(m), squares = sum;
  double samples = 0.0;
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train) continue;
    for (Index k = 0; k < run.samples(); ++k) {
      const Eigen::VectorXd u = run.inputs().col(k);
      if (!u.allFinite()) continue;
      samples += 1.0;
      const Eigen::VectorXd from = u - sum;
      sum += from / samples;
      squares += from.cwiseProduct(u - sum);
    }
  }
  return (squares / std::max(1.0, samples)).cwiseSqrt();
}

struct Pair {
  Index state = 0, input = 0;
  double effect = 0.0;
};

/// All pairs, those that move most first.
std::vector<Pair> pairs_of(const Bank& single, const Recording& recording) {
  const Eigen::MatrixXd& gain = single.modes.front().response.value.gain;
  const Eigen::VectorXd deviation = deviation_of_inputs(recording);
  std::vector<Pair> pairs;
  for (Index i = 0; i < gain.rows(); ++i)
    for (Index j = 0; j < gain.cols(); ++j)
      pairs.push_back({i, j, std::isfinite(gain(i, j)) ? std::abs(gain(i, j)) * deviation(j) : 0.0});
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.effect > b.effect; });
  return pairs;
}

/// " K/W"; the unit of the state alone where the input has none.
std::string unit_of_gain(const Channel& state, const Channel& input) {
  if (state.unit.empty() || state.unit == input.unit) return "";
  return input.unit.empty() ? " " + state.unit : fmt::format(" {}/{}", state.unit, input.unit);
}

/// Increase per second of one state whose pole lies near 1, after the other poles have settled; NaN for several states.
double slope_per_s(const Bank& single, Index input) {
  const LinearStructure& s = single.structure;
  if (s.states > 1) return std::nan("");
  const LinearModel& model = single.modes.front().model;
  double effect = 0.0, age = 0.0;
  for (Index lag = 0; lag < s.input_lags; ++lag) effect += model.B(0, lag * s.inputs + input);
  for (Index lag = 1; lag < s.state_lags; ++lag) age += static_cast<double>(lag) * model.A(0, lag);
  return effect / (1.0 + age) / single.dt_s;  // residue at 1: B(1) / (1 + sum of j a_j)
}

std::string words_of(const Bank& single, const Channel& state, const Channel& input, const Pair& pair,
                     const std::string& unit) {
  const EstimatedStepResponse& response = single.modes.front().response;
  const auto [i, j, effect] = pair;
  const double gain = response.value.gain(i, j), error = response.error.gain(i, j);
  const double radius = response.value.radius, off = response.error.radius;
  const std::string name = fmt::format("{} per {}: ", state.name, input.name);
  const bool at_one = !(radius + (std::isfinite(off) ? 2.0 * off : 0.0) < 1.0);
  const double least = radius - (std::isfinite(off) ? 2.0 * off : 0.0);
  const std::string slower = least > 0.0 && least < 1.0
                                 ? fmt::format("slower than {:.2g} {}", -single.dt_s / std::log(least), unit)
                                 : std::string("not within the runs");
  if (at_one) {
    const double slope = slope_per_s(single, j);
    const std::string rate =
        std::isfinite(slope) ? fmt::format(" {:.3g}{} per {}", slope, unit_of_gain(state, input), unit) : std::string();
    return name + "integrates" + rate + ", or settles " + slower;
  }
  if (!(error <= std::abs(gain) / 3.0) && !std::isnan(error)) return name + "settles " + slower;
  std::string text =
      fmt::format("{}63 % of {}{} after {} {}", name, estimate_text(gain, error), unit_of_gain(state, input),
                  estimate_text(response.value.response_s(i, j), response.error.response_s(i, j)), unit);
  if (const double settling = response.value.settling_s(i, j); std::isfinite(settling))
    text += fmt::format(", within 5 % after {:.3g} {}", settling, unit);
  if (const double over = response.value.overshoot(i, j); over > 0.05)
    text += fmt::format(", overshoot {:.0f} %", 100.0 * over);
  return text;
}

}  // namespace

std::string response_words(const Bank& single, const Recording& recording, Index most, const std::string& unit) {
  const std::vector<Pair> pairs = pairs_of(single, recording);
  std::vector<std::string> words;
  for (const Pair& pair : pairs)
    if (most == 0 || std::ssize(words) < most)
      words.push_back(words_of(single, recording.states[static_cast<std::size_t>(pair.state)],
                               recording.inputs[static_cast<std::size_t>(pair.input)], pair, unit));
  return fmt::format("{}", fmt::join(words, "; "));
}

}  // namespace modebank::app
