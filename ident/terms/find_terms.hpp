#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/fit/options.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/terms.hpp"

namespace modebank {

/// Terms of one structure, and how these predicted rows that were left out.
struct TriedTerms {
  LinearStructure structure;
  Eigen::Index terms = 0;
  double log_score = 0.0;  ///< of rows that fitted no coefficients, but chose the terms [nats/sample]
};

/// The motion that bends, if any does.
struct FoundTerms {
  LinearStructure structure;  ///< with the lags that terms want
  MotionTerms terms = {};     ///< empty: none are taken
  double gain = 0.0;          ///< over the linear model of all lags, on halves that chose nothing [nats/sample]
  double gain_standard_error = 0.0;
  Eigen::Index terms_asked = 0;  ///< that the gain was measured for; 0: no structure had any
  std::vector<TriedTerms> tried = {};
};

/// Nats per sample that terms must gain, beside two standard errors.
inline constexpr double least_terms_gain = 0.02;

/// Whether one motion of the training runs bends, and how (method: section 2a, item 4). Terms are selected with one
/// lag, with two and with those of `structure`, since linear lags stand in for a bend; fewer columns within one
/// standard error of the best left-out score. What they gain over the linear model is measured on each half of the
/// training runs by terms that the other half chose. They are taken for 0.02 nats and two standard errors. The same
/// for any number of threads. Throws DataError without a transition to learn from.
FoundTerms find_terms(const Recording& recording, const LinearStructure& structure, const FitOptions& options);

}  // namespace modebank
