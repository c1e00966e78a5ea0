#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/judge/decide/finding.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app {

/// Errors of the bank's predictions. For comparison, the errors of the finding's best competitor and of all filters
/// combined.
struct ErrorAhead {
  Index steps = 1;
  Eigen::VectorXd bank;                  ///< n_y, root mean square [state unit]
  Eigen::VectorXd competitor, combined;  ///< n_y, root mean square [state unit]; empty if unknown
  double coverage_95 = not_a_number;     ///< share of the samples inside the bank's 95 % band; NaN if unknown
  Eigen::VectorXd fit_percent;           ///< n_y, FIT of the bank [%]; empty if unknown
  std::string bank_words,
      other_words;  ///< texts: the bank's errors with units; the errors of the competitor and of `combined`, each with
                    ///< its name
};

/// Errors one step ahead and at the longest scored horizon. `competitor` is empty if there is none.
std::vector<ErrorAhead> errors_ahead(const Archive& archive, Role role, const std::string& competitor);

/// Text such as "71.2 %", or "71.2 %, 65.0 %" with two states.
std::string fit_words(const Eigen::VectorXd& fit);

}  // namespace modebank::app
