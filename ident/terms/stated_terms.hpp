#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ident/model/terms.hpp"

namespace modebank {

/// A term as the user writes it, with names of regressors as variables.
struct StatedTerm {
  TermKind kind = TermKind::product;
  std::vector<std::string> names;  ///< one to three variables for a product (repeats allowed), one variable for other
                                   ///< terms
  double knot = 0.0;               ///< knot of a hinge, in the unit of its variable

  bool operator==(const StatedTerm&) const = default;
};

/// Whether window.terms is a list of terms, not the word auto or none.
inline bool lists_terms(const std::string& choice) { return choice != "auto" && choice != "none"; }

/// Parses "vx * wz, |vx|, max(0, wz[k-1] - 0.3)", the format of printed equations. Throws std::invalid_argument, whose
/// message quotes the unreadable part.
std::vector<StatedTerm> read_terms(const std::string& text);

/// Converts the terms to terms of regressors (N x q) with these q names. A name without a sample means the newest
/// sample. Ranges and units (root mean squares) are those of the rows. Throws DataError for an unknown name; the
/// message lists the names.
MotionTerms stated_terms(const std::vector<StatedTerm>& stated, const std::vector<std::string>& names,
                         const Eigen::MatrixXd& regressors);

}  // namespace modebank
