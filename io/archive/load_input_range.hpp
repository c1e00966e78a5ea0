#pragma once

#include <Eigen/Core>

#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// The smallest and the largest value of each input (m) in the training runs of an archive. Empty if the archive has no
/// runs; NaN for an input that has no values.
struct InputRange {
  Eigen::VectorXd least, largest;
};

/// Reads only the inputs of the training runs. Throws the same exceptions as load_bank.
InputRange load_input_range(const OpenArchive& archive);

}  // namespace modebank
