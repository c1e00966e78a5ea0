#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/judge/finding.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app {

/// Errors of a filter's predictions. For comparison, the errors of another filter and of all filters combined.
struct ErrorAhead {
  Index steps = 1;
  Eigen::VectorXd rmse;               ///< n_y, root mean square [state unit]
  Eigen::VectorXd combined;           ///< the same; empty if unknown
  double coverage_95 = not_a_number;  ///< share of the samples inside the filter's 95 % band; NaN if unknown
  Eigen::VectorXd fit_percent;        ///< n_y, FIT of the filter [%]; empty if unknown
  std::string words, other_words;  ///< texts: the filter's errors with units; those of the others, each with its name
};

/// Errors one step ahead and at the longest scored horizon. `other` is empty if there is none.
std::vector<ErrorAhead> errors_ahead(const Archive& archive, Role role, const std::string& filter,
                                     const std::string& other);

/// Text such as "71.2 %", or "71.2 %, 65.0 %" with two states.
std::string fit_words(const Eigen::VectorXd& fit);

}  // namespace modebank::app
