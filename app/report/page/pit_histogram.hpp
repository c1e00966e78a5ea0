#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/judge/decide/diagnostics.hpp"
#include "io/archive/archive.hpp"

namespace modebank {

/// Histogram of probability integral transforms, which are uniform on [0, 1] for a true filter (Diebold, Gunther & Tay
/// 1998).
struct PitHistogram {
  Eigen::VectorXi counts;    ///< per bin
  Eigen::Index samples = 0;  ///< number of known transforms
  double expected = 0.0;     ///< per bin
  Interval band{0.0, 0.0};   ///< 95 % interval of a single bin's count for a true filter
};

/// The histogram over all outputs of these runs. Throws std::invalid_argument unless bins >= 2.
PitHistogram pit_histogram(const FilterEvaluation& evaluation, const std::vector<std::size_t>& runs, Eigen::Index bins);

}  // namespace modebank
