#pragma once

#include <Eigen/Core>

#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// The smallest and the largest value of each input (m) in the training runs of an archive; empty without runs. NaN for
/// an input without values.
struct InputRange {
  Eigen::VectorXd least, largest;
};

/// Reads only the training runs' inputs. Throws as load_bank does.
InputRange load_input_range(const OpenArchive& archive);

}  // namespace modebank
