#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <vector>

#include "filter/judge/decide/finding.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app {

/// How far predictions are off, beside those of the finding's best competitor and of all filters combined.
struct ErrorAhead {
  Index steps = 1;
  Eigen::VectorXd bank;                  ///< n_y, root mean square [state unit]
  Eigen::VectorXd competitor, combined;  ///< n_y, the same; empty where not known
  Eigen::VectorXd other;                 ///< n_y, of each state the least of all competitors; empty where not known
  Eigen::VectorXd fit_percent;           ///< n_y, FIT of the bank [%]; empty where not known
  std::string bank_words, other_words;   ///< the bank's with units; the competitor's and combined's with their names
};

/// One step ahead, and as far as was looked ahead. `competitor`: empty without.
std::vector<ErrorAhead> errors_ahead(const Archive& archive, Role role, const std::string& competitor);

/// The values of the competitor that is best at each state. `value_of`: a competitor's numbers, null without.
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

/// "71.2 %", or of several states "71.2 %, 65.0 %".
std::string fit_words(const Eigen::VectorXd& fit);

}  // namespace modebank::app
