#pragma once

#include <string>
#include <vector>

#include "ident/model/linear_model.hpp"
#include "ident/model/local_model.hpp"

namespace modebank {

/// Label of each parameter, with the names of the data, in the order of theta. "wz <- velL" is the coefficient of velL
/// in the increment of wz. With lags the label also has the number of samples between the two: "wz <- wz (lag 2)". The
/// constant is "wz <- 1". If names list all lagged samples, as in a bank ("wz", "wz[k-1]"), the first names are used,
/// without their suffix. Missing names become "x1", "x2", ... and "u1", "u2", ...
std::vector<std::string> parameter_labels(const LinearStructure& structure, const std::vector<std::string>& states,
                                          const std::vector<std::string>& inputs);

/// Labels of the regressors without the constant: "wz (lag 2)", "velL".
std::vector<std::string> regressor_labels(const LinearStructure& structure, const std::vector<std::string>& states,
                                          const std::vector<std::string>& inputs);

/// Parameter labels of windows; a motion model's parameters have their own names.
std::vector<std::string> parameter_labels(const WindowFits& fits, const std::vector<std::string>& states,
                                          const std::vector<std::string>& inputs);

}  // namespace modebank
