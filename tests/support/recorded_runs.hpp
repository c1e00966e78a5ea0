#pragma once

#include <cstring>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "modebank/base/eigen.hpp"
#include "modebank/base/recording.hpp"

namespace modebank::test {

/// The recording in the type of the public API.
inline RecordedRuns recorded_runs(const Recording& recording) {
  RecordedRuns result{{}, names_of(recording.states), names_of(recording.inputs)};
  for (const Trajectory& run : recording.runs)
    result.runs.push_back(
        {run.run, run.role == Role::test, to_vector(run.time_s), to_matrix(run.state), to_matrix(run.input)});
  return result;
}

/// Whether `a` and `b` have the same numbers, NaN included.
inline bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}
inline bool same_bits(const Matrix& a, const Matrix& b) {
  return a.rows == b.rows && a.cols == b.cols && same_bits(a.values, b.values);
}

}  // namespace modebank::test
