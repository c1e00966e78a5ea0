#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/judge/diagnostics.hpp"
#include "io/archive/archive.hpp"

namespace modebank {

/// Histogram of probability integral transforms. If the model is right, they are uniform on [0, 1] (Diebold, Gunther &
/// Tay 1998).
struct PitHistogram {
  Eigen::VectorXi counts;    ///< per bin
  Eigen::Index samples = 0;  ///< number of transforms that are not NaN
  double expected = 0.0;     ///< per bin
  Interval band{0.0, 0.0};   ///< 95 % interval of the count in one bin if the model is right
};

/// The histogram over all measured states of these runs. Throws std::invalid_argument unless bins >= 2.
PitHistogram pit_histogram(const FilterEvaluation& evaluation, const std::vector<std::size_t>& runs, Eigen::Index bins);

}  // namespace modebank
