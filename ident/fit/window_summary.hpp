#pragma once

#include <Eigen/Core>

#include "ident/model/local_model.hpp"

namespace modebank {

/// Summary of all windows of one fit. Each figure is a median over the windows in which it is defined; NaN if there is
/// no such window.
struct WindowSummary {
  Eigen::VectorXd parameter;       ///< p, median of each parameter
  Eigen::VectorXd standard_error;  ///< p, median
  Eigen::VectorXd significant;     ///< p, share of the windows in which |t value| > 2
  Eigen::VectorXd r_squared;       ///< n, median
};

WindowSummary summarize(const WindowFits& fits);

}  // namespace modebank
