#pragma once

#include <Eigen/Core>
#include <random>

#include "ident/simulate/simulate.hpp"

namespace modebank {

/// Inputs of one simulated run, m x samples, as the actuators apply them. They are drawn by options.input_law and
/// rounded to multiples of options.input_quantum. The generator is the only source of randomness.
Eigen::MatrixXd draw_inputs(const CommandOptions& options, std::mt19937_64& generator);

}  // namespace modebank
