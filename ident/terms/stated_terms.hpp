#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ident/model/terms.hpp"

namespace modebank {

/// A term in words: the names of its variables, which regressors have.
struct StatedTerm {
  TermKind kind = TermKind::product;
  std::vector<std::string> names;  ///< one to three of a product, which may repeat; one of the others
  double knot = 0.0;               ///< of a hinge, in the variable's unit

  bool operator==(const StatedTerm&) const = default;
};

/// Whether window.terms lists terms: any text but auto and none.
inline bool lists_terms(const std::string& choice) { return choice != "auto" && choice != "none"; }

/// "vx * wz, |vx|, max(0, wz[k-1] - 0.3)", as equations print them. Throws std::invalid_argument, whose message states
/// the part that cannot be read.
std::vector<StatedTerm> read_terms(const std::string& text);

/// The same as terms of regressors (N x q) with these q names. A name without a sample means the newest one. Ranges are
/// those of the rows, units their root mean squares. Throws DataError, which lists the names, for one that is not
/// there.
MotionTerms stated_terms(const std::vector<StatedTerm>& stated, const std::vector<std::string>& names,
                         const Eigen::MatrixXd& regressors);

}  // namespace modebank
