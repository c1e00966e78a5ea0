#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/fit/options.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/terms.hpp"

namespace modebank {

/// Terms of one structure, and their score on left-out rows.
struct TriedTerms {
  LinearStructure structure;
  Eigen::Index terms = 0;
  double log_score = 0.0;  ///< log score on rows that helped to choose the terms but not to fit the coefficients
                           ///< [nats/sample]
};

/// The nonlinear motion, if one was found.
struct FoundTerms {
  LinearStructure structure;  ///< structure with the lags that were chosen together with the terms
  MotionTerms terms = {};     ///< terms of the motion; empty if no terms were accepted
  double gain = 0.0;  ///< gain over the linear model with all lags, on halves that were not used to choose the terms
                      ///< [nats/sample]
  double gain_standard_error = 0.0;
  Eigen::Index terms_asked = 0;  ///< number of terms whose gain was measured; 0 if no structure had terms
  std::vector<TriedTerms> tried = {};
};

/// Smallest gain of accepted terms in nats per sample. The gain must also be above two standard errors.
inline constexpr double least_terms_gain = 0.02;

/// Decides whether one motion of the training runs is nonlinear, and selects its terms (method: section 2a, item 4).
/// Terms are selected with one lag, with two lags and with the lags of `structure`, because linear lags can replace a
/// nonlinearity. Among these three results, those within one standard error of the best score on left-out rows are
/// considered. The result with the fewest columns is chosen. The gain over the linear model is measured on each half of
/// the training runs, with terms chosen on the other half. It must reach 0.02 nats and two standard errors. The result
/// is the same for any number of threads. Throws DataError without usable transitions.
FoundTerms find_terms(const Recording& recording, const LinearStructure& structure, const FitOptions& options);

}  // namespace modebank
