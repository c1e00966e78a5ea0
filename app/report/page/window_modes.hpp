#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "ident/data/window.hpp"

namespace modebank {

/// The mode that a filter found most probable over each window, by the mean of mode_probability over its transitions;
/// -1 where none is known. `length` transitions per window; evaluations in the order of the recording's runs.
Eigen::VectorXi window_modes(const std::vector<Window>& windows, Eigen::Index length,
                             const std::vector<RunEvaluation>& evaluations);

}  // namespace modebank
