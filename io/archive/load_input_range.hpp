#pragma once

#include <Eigen/Core>

#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// The smallest and the largest value of each input (m) in the training runs of an archive. Empty without runs; NaN for
/// an input without values.
struct InputRange {
  Eigen::VectorXd least, largest;
};

/// Reads only the inputs of the training runs. Throws as load_bank does.
InputRange load_input_range(const OpenArchive& archive);

}  // namespace modebank
