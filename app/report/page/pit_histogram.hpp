#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/judge/decide/diagnostics.hpp"
#include "io/archive/archive.hpp"

namespace modebank {

/// How the probability transforms of a true filter spread: equally over bins of [0, 1] (Diebold, Gunther & Tay 1998).
struct PitHistogram {
  Eigen::VectorXi counts;    ///< per bin
  Eigen::Index samples = 0;  ///< transforms that are known
  double expected = 0.0;     ///< per bin
  Interval band{0.0, 0.0};   ///< a bin of a true filter has a count from `lower` to `upper` with 95 %, each on its own
};

/// Over all outputs of these runs. Throws std::invalid_argument unless bins >= 2.
PitHistogram pit_histogram(const FilterEvaluation& evaluation, const std::vector<std::size_t>& runs, Eigen::Index bins);

}  // namespace modebank
