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
  require(run.weight.empty() || static_cast<Index>(run.weight.size()) == samples, run,
          "there are " + std::to_string(run.weight.size()) + " weights for " + std::to_string(samples) + " samples");
  require(std::all_of(run.weight.begin(), run.weight.end(), [](double w) { return w >= 0.0 && w < 1e300; }), run,
          "a weight is negative or not finite");
  require(std::adjacent_find(run.time_s.begin(), run.time_s.end(), std::not_fn(std::less<>())) == run.time_s.end(), run,
          "times do not increase");
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
  trajectory.weight = view(run.weight);
  return trajectory;
}

}  // namespace modebank
