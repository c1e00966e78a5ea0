#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/window.hpp"
#include "io/archive/archive.hpp"

namespace modebank {

/// A filter's most probable mode over each window, by the mean of mode_probability over the window's transitions. -1 if
/// unknown. `length`: transitions per window.
Eigen::VectorXi window_modes(const std::vector<Window>& windows, Eigen::Index length,
                             const FilterEvaluation& evaluation);

}  // namespace modebank
