#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/window.hpp"
#include "io/archive/archive.hpp"

namespace modebank {

/// The mode that a filter found most probable over each window, by the mean of mode_probability over its transitions;
/// -1 where none is known. `length` transitions per window.
Eigen::VectorXi window_modes(const std::vector<Window>& windows, Eigen::Index length,
                             const FilterEvaluation& evaluation);

}  // namespace modebank
