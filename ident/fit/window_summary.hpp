#pragma once

#include <Eigen/Core>

#include "ident/model/local_model.hpp"

namespace modebank {

/// What the windows of one fit have in common, medians over those where the value is defined (NaN where it never is).
struct WindowSummary {
  Eigen::VectorXd parameter;       ///< p, median theta
  Eigen::VectorXd standard_error;  ///< p, median
  Eigen::VectorXd significant;     ///< p, share of the windows with |t value| > 2
  Eigen::VectorXd r_squared;       ///< n, median
  double aic = 0.0;                ///< median
};

WindowSummary summarize(const WindowFits& fits);

}  // namespace modebank
