#pragma once

#include <Eigen/Core>
#include <algorithm>
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
  Eigen::VectorXd other;                 ///< n_y, the smallest error of all competitors for each state; empty if
                                         ///< unknown
  double coverage_95 = not_a_number;     ///< share of the samples inside the bank's 95 % band; NaN if unknown
  Eigen::VectorXd fit_percent;           ///< n_y, FIT of the bank [%]; empty if unknown
  std::string bank_words,
      other_words;  ///< texts: the bank's errors with units; the errors of the competitor and of `combined`, each with
                    ///< its name
};

/// Errors one step ahead and at the longest scored horizon. `competitor` is empty if there is none.
std::vector<ErrorAhead> errors_ahead(const Archive& archive, Role role, const std::string& competitor);

/// For each state, the value of the best competitor for this state. `value_of` returns the values of a competitor, or
/// null.
template <class ValueOf, class Better>
Eigen::VectorXd best_of_competitors(ValueOf value_of, Better better) {
  Eigen::VectorXd best;
  for (const char* name : competitor_names) {
    const Eigen::VectorXd* values = value_of(name);
    if (!values) continue;
    if (best.size() == 0) best = *values;
    for (Index i = 0; i < std::min(values->size(), best.size()); ++i)
      if (better((*values)(i), best(i))) best(i) = (*values)(i);
  }
  return best;
}

/// Text such as "71.2 %", or "71.2 %, 65.0 %" with two states.
std::string fit_words(const Eigen::VectorXd& fit);

}  // namespace modebank::app
