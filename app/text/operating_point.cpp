#include "app/text/operating_point.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "ident/base/linalg.hpp"

namespace modebank::app {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const Channel& column(const Recording& recording, Index c) {
  const Index n = recording.state_count();
  return c < n ? recording.states[static_cast<std::size_t>(c)] : recording.inputs[static_cast<std::size_t>(c - n)];
}

std::string with_unit(const std::string& words, const Channel& channel) {
  return channel.unit.empty() ? words : words + " " + channel.unit;
}

std::string named(const Channel& channel, double value) {
  return with_unit(fmt::format("{} {:.4g}", channel.name, value), channel);
}

/// Response to the inputs of a run from rest at its first input, n x N. A model of differences in levels has a pole at
/// 1 that its inputs cancel, so it stays where it begins: here at the steady value.
MatrixXd response_to(const Bank& single, const Trajectory& run) {
  const LinearStructure& s = single.structure;
  const LinearModel& model = single.modes.front().model;
  const MatrixXd gain = s.inputs > 0 ? single.modes.front().response.value.gain : MatrixXd(MatrixXd::Zero(s.states, 0));
  MatrixXd inputs = run.inputs(), response(s.states, run.samples());
  for (Index k = 1; k < inputs.cols(); ++k)
    for (Index i = 0; i < inputs.rows(); ++i)
      if (!std::isfinite(inputs(i, k))) inputs(i, k) = inputs(i, k - 1);
  VectorXd z = VectorXd(gain * inputs.col(0)).replicate(s.state_lags, 1), v(s.acting_inputs());
  for (Index k = 0; k < response.cols(); ++k) {
    response.col(k) = z.head(s.states);
    for (Index lag = 0; lag < s.input_lags; ++lag)
      for (Index i = 0; i < s.inputs; ++i)
        v(lag * s.inputs + i) = inputs(i, std::clamp<Index>(k + 1 - s.input_delay[i] - lag, 0, inputs.cols() - 1));
    z = model.next(z, v);
  }
  return response;
}

/// Standard deviation of the level of each state; empty where an input's effect has no end.
VectorXd level_deviation(const Bank& single, const Recording& recording) {
  const StepResponse& response = single.modes.front().response.value;
  if (!response.gain.allFinite()) return {};
  double settling_s = 0.0;
  for (const double value : response.settling_s.reshaped())
    if (std::isfinite(value)) settling_s = std::max(settling_s, value);
  Spread level(recording.state_count());
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train || run.samples() == 0) continue;
    const double settled = 2.0 * settling_s / single.dt_s, half = static_cast<double>(run.samples()) / 2.0;
    level.add((run.states() - response_to(single, run))
                  .rightCols(run.samples() - static_cast<Index>(std::min(settled, half))));
  }
  return (level.deviation().cwiseAbs2() - single.R.diagonal()).cwiseMax(0.0).cwiseSqrt();
}

}  // namespace

std::string operating_words(const Bank& single, const Recording& recording) {
  constexpr Index most_columns = 4;
  const Index n = recording.state_count(), m = recording.input_count();
  Spread all(n + m);
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train) all.add((MatrixXd(n + m, run.samples()) << run.states(), run.inputs()).finished());
  if (n + m > most_columns || !(all.count.minCoeff() > 0.0)) return "";
  std::vector<std::string> means, at_zero;
  for (Index c = 0; c < n + m; ++c) means.push_back(named(column(recording, c), all.mean(c)));
  std::string text = fmt::format("means: {}", fmt::join(means, ", "));
  const auto& [value, error, never_settles] = single.modes.front().response;
  if (value.radius.size() == 0) return text;
  const bool settles = value.radius(0) + (std::isfinite(error.radius(0)) ? 2.0 * error.radius(0) : 0.0) < 1.0;
  const bool within = all.low.tail(m).maxCoeff() <= 0.0 && all.high.tail(m).minCoeff() >= 0.0;
  if (!single.structure.intercept || !settles || !within) return text;
  const LinearModel& model = single.modes.front().model;
  const VectorXd rest = PivotedLu(-model.A).solve(model.c);
  for (Index i = 0; i < n; ++i) at_zero.push_back(named(column(recording, i), rest(i)));
  return text + fmt::format("; {} at zero input", fmt::join(at_zero, ", "));
}

std::string level_doubt(const Archive& archive) {
  if (!archive.structure || !archive.structure->differences || !archive.baseline || !archive.recording) return "";
  const VectorXd deviation = level_deviation(*archive.baseline, *archive.recording);
  std::vector<std::string> sizes;
  for (Index i = 0; i < deviation.size(); ++i)
    sizes.push_back(with_unit(fmt::format("{:.2g}", deviation(i)), column(*archive.recording, i)));
  return fmt::format("the level of {} wanders or differs by run{}: something that acts is not logged",
                     fmt::join(names_of(archive.recording->states), ", "),
                     sizes.empty() ? "" : fmt::format(" (sd {})", fmt::join(sizes, ", ")));
}

}  // namespace modebank::app
