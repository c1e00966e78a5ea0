#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/window.hpp"
#include "io/archive/archive.hpp"

namespace modebank {

/// The most probable mode of a filter over each window, by the mean of mode_probability over the window's transitions.
/// -1 if it is unknown. `length`: number of transitions per window.
Eigen::VectorXi window_modes(const std::vector<Window>& windows, Eigen::Index length,
                             const FilterEvaluation& evaluation);

}  // namespace modebank
