#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ident/model/linear_model.hpp"
#include "ident/model/terms.hpp"

namespace modebank {

/// The motion as one reads it: for each state "wz[k+1] = 0.71 wz[k] + 0.2 left[k] + 0.12 max(0, p1 - 0.4)", then what
/// directions are, "p1 = 0.1 left[k] - 0.1 right[k]", and the training ranges that variables of terms are clipped to.
/// `bend`: measured states x T. Names are a bank's, with their lags; unless each
/// regressor has one, the result is empty.
std::vector<std::string> equations(const LinearStructure& structure, const LinearModel& model, const MotionTerms& terms,
                                   const Eigen::MatrixXd& bend, const std::vector<std::string>& state_names,
                                   const std::vector<std::string>& input_names);

}  // namespace modebank
