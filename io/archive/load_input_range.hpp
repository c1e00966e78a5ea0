#pragma once

#include <Eigen/Core>

#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// The least and the largest value of each input (m) in the training runs of an archive; empty where it holds no runs.
/// An input that no training run has is NaN in both.
struct InputRange {
  Eigen::VectorXd least, largest;
};

/// Reads the training runs' inputs alone. Throws as load_bank does.
InputRange load_input_range(const OpenArchive& archive);

}  // namespace modebank
