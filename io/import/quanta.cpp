#include "io/import/quanta.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "ident/check/stream_check.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

using Eigen::VectorXd;

/// Smallest step that matters, as a share of the residuals' standard deviation. Rounding to a smaller step adds less
/// than a hundredth to the residuals' variance.
constexpr double least_share = 1.0 / 3.0;

/// All values of a state in the training runs, without missing values.
VectorXd training_values(const Recording& recording, Index state) {
  std::vector<double> values;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train)
      for (const double value : run.state.row(state)) values.push_back(value);
  return VectorXd::Map(values.data(), std::ssize(values));
}

/// Standard deviation of a state's increments in the training runs, after regression on states, inputs and a constant.
double residual_deviation(const Recording& recording, Index state) {
  const Index n = recording.state_count(), m = recording.input_count(), p = n + m + 1;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(p + 1, p + 1);
  VectorXd row(p + 1);
  double count = 0.0;
  for (const Trajectory& run : recording.runs)
    for (Index k = 0; run.role == Role::train && k < run.transitions(); ++k) {
      row << run.state.col(k), run.input.col(k), 1.0, run.state(state, k + 1) - run.state(state, k);
      if (!row.allFinite()) continue;
      normal.noalias() += row * row.transpose();
      count += 1.0;
    }
  if (count <= static_cast<double>(p)) return 0.0;
  const VectorXd theta = normal.topLeftCorner(p, p).completeOrthogonalDecomposition().solve(normal.col(p).head(p));
  const double squares =
      normal(p, p) - 2.0 * theta.dot(normal.col(p).head(p)) + theta.dot(normal.topLeftCorner(p, p) * theta);
  return std::sqrt(std::max(0.0, squares) / (count - static_cast<double>(p)));
}

VectorXd found_quanta(const Recording& recording) {
  VectorXd quanta(recording.state_count());
  for (Index i = 0; i < quanta.size(); ++i) {
    quanta(i) = check_channel(training_values(recording, i)).quantum;
    if (quanta(i) > 0.0 && !(quanta(i) >= least_share * residual_deviation(recording, i))) quanta(i) = 0.0;
  }
  return quanta;
}

std::string told(const Recording& recording, const VectorXd& quanta) {
  std::vector<std::string> texts;
  for (Index i = 0; i < quanta.size(); ++i)
    if (quanta(i) > 0.0)
      texts.push_back(fmt::format("{} by {:.6g}", recording.states[static_cast<std::size_t>(i)].name, quanta(i)));
  return fmt::format("{}", fmt::join(texts, ", "));
}

}  // namespace

bool is_interpolated(const Stream& states, const Trajectory& joined) {
  const double same = 1e-6 * median_period_s(states.time_s);
  for (const double time_s : joined.time_s) {
    const auto after = std::lower_bound(states.time_s.begin(), states.time_s.end(), time_s - same);
    if (after == states.time_s.end() || *after > time_s + same) return true;
  }
  return false;
}

void Quanta::look_at(const RunStreams& run, const Trajectory& joined) {
  if (!options_.quantum_auto && options_.quantum.empty()) return;
  if (rounded_ || !is_interpolated(run.states.stream, joined)) return;
  interpolated_ = true;
  if (!options_.quantum_auto) return;
  const Eigen::MatrixXd& values = run.states.stream.values;
  for (Index i = 0; i < values.rows(); ++i) rounded_ = rounded_ || check_channel(values.row(i)).quantum > 0.0;
}

VectorXd Quanta::decide(const Recording& recording, std::vector<std::string>& notes) const {
  const Index n = recording.state_count(), given = std::ssize(options_.quantum);
  if (!options_.quantum_auto && given == 0) return {};
  if (!options_.quantum_auto && given != 1 && given != n)
    throw ConfigurationError(fmt::format(
        "data.quantum has {} values, but data.state {} columns; give one per state, or one for all", given, n));
  if (interpolated_) {
    if (rounded_ || given > 0)
      notes.push_back(
          "states are interpolated between rounded samples, so they are not multiples of a step and count as exact "
          "(data.quantum)");
    return {};
  }
  VectorXd quanta;
  if (options_.quantum_auto)
    quanta = found_quanta(recording);
  else if (given == 1)
    quanta.setConstant(n, options_.quantum.front());
  else
    quanta = VectorXd::Map(options_.quantum.data(), n);
  if (!(quanta.array() > 0.0).any()) return {};
  if (options_.quantum_auto)
    notes.push_back(fmt::format("states are rounded ({}), so R is at least q^2 / 12 (data.quantum = auto)",
                                told(recording, quanta)));
  return quanta;
}

}  // namespace modebank
