#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ident/model/linear_model.hpp"
#include "ident/model/terms.hpp"

namespace modebank {

/// The motion as readable equations. Each state has one equation: "wz[k+1] = 0.71 wz[k] + 0.2 left[k] + 0.12 max(0, p1
/// - 0.4)". The directions follow, "p1 = 0.1 left[k] - 0.1 right[k]", and then the training ranges to which variables
/// are clipped. `bend`: measured states x T. Names are those of a bank, with lags. The result is empty unless each
/// regressor has a name.
std::vector<std::string> equations(const LinearStructure& structure, const LinearModel& model, const MotionTerms& terms,
                                   const Eigen::MatrixXd& bend, const std::vector<std::string>& state_names,
                                   const std::vector<std::string>& input_names);

}  // namespace modebank
