#include "ident/data/public_recording.hpp"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "modebank/base/eigen.hpp"

namespace modebank {

namespace {

void require(bool holds, const RecordedRun& run, const std::string& what) {
  if (!holds) throw std::invalid_argument("run \"" + run.name + "\": " + what);
}

std::string shape(const Matrix& matrix) { return std::to_string(matrix.rows) + " x " + std::to_string(matrix.cols); }

void check(const RecordedRun& run, Index states, Index inputs) {
  const Index samples = static_cast<Index>(run.time_s.size());
  const auto fits = [&](const Matrix& signal, Index rows) {
    return signal.rows == rows && signal.cols == samples && static_cast<Index>(signal.values.size()) == rows * samples;
  };
  require(fits(run.state, states), run,
          "state is " + shape(run.state) + ", not " + std::to_string(states) + " x " + std::to_string(samples));
  require(fits(run.input, inputs), run,
          "input is " + shape(run.input) + ", not " + std::to_string(inputs) + " x " + std::to_string(samples));
  require(std::adjacent_find(run.time_s.begin(), run.time_s.end(), std::not_fn(std::less<>())) == run.time_s.end(), run,
          "times do not increase");
}

std::vector<Channel> channels(const std::vector<std::string>& names, Index count, const char* what,
                              const char* prefix) {
  if (!names.empty() && std::ssize(names) != count)
    throw std::invalid_argument("there are " + std::to_string(names.size()) + " " + what + "_names for " +
                                std::to_string(count) + " rows of " + what);
  std::vector<Channel> result;
  for (Index i = 0; i < count; ++i)
    result.push_back({names.empty() ? prefix + std::to_string(i + 1) : names[static_cast<std::size_t>(i)], ""});
  return result;
}

}  // namespace

Trajectory to_trajectory(const RecordedRun& run, Index states, Index inputs) {
  check(run, states, inputs);
  Trajectory trajectory;
  trajectory.run = run.name;
  trajectory.role = run.held_out ? Role::test : Role::train;
  trajectory.time_s = view(run.time_s);
  trajectory.state = view(run.state);
  trajectory.input = view(run.input);
  return trajectory;
}

Recording to_recording(const RecordedRuns& given) {
  if (given.runs.empty()) throw std::invalid_argument("there are no runs");
  const Index states = given.runs.front().state.rows, inputs = given.runs.front().input.rows;
  Recording recording;
  recording.states = channels(given.state_names, states, "state", "x");
  recording.inputs = channels(given.input_names, inputs, "input", "u");
  for (const RecordedRun& run : given.runs) recording.runs.push_back(to_trajectory(run, states, inputs));
  return recording;
}

}  // namespace modebank
