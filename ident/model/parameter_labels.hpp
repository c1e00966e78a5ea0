#pragma once

#include <string>
#include <vector>

#include "ident/model/linear_model.hpp"
#include "ident/model/local_model.hpp"

namespace modebank {

/// What each parameter is, in the data's own names and in theta's order: "wz <- velL" weighs velL in the increment of
/// wz. With lags each says how many samples lie between: "wz <- wz (lag 2)"; the constant is "wz <- 1". Names may be
/// those of all lagged samples, as a bank's are ("wz", "wz[k-1]"): the first ones count, without their "[k-1]". Missing
/// ones are "x1", "x2", ... and "u1", "u2", ...
std::vector<std::string> parameter_labels(const LinearStructure& structure, const std::vector<std::string>& states,
                                          const std::vector<std::string>& inputs);

/// What predicts, without the constant: "wz (lag 2)", "velL".
std::vector<std::string> regressor_labels(const LinearStructure& structure, const std::vector<std::string>& states,
                                          const std::vector<std::string>& inputs);

/// Of windows; a motion model's parameters have names of their own.
std::vector<std::string> parameter_labels(const WindowFits& fits, const std::vector<std::string>& states,
                                          const std::vector<std::string>& inputs);

}  // namespace modebank
