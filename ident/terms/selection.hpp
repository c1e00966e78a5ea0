#pragma once

#include <Eigen/Core>

#include "ident/fit/options.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/terms.hpp"
#include "ident/terms/term_rows.hpp"

namespace modebank {

/// Terms that a forward selection takes, the most important first.
struct SelectedTerms {
  LinearStructure structure;
  MotionTerms terms;              ///< selected terms; empty if the linear model predicts left-out rows equally well
  Eigen::VectorXd left_out = {};  ///< N, log density of each row, summed over the states; the coefficients are fitted
                                  ///< without the row
  double log_score() const { return left_out.mean(); }
};

/// Forward selection of terms of one structure by their gain on left-out parts of the rows. Chooses the smallest number
/// of terms whose gain is within one standard error of the best. Coefficients come from Gram matrices without each
/// fold. Targets are those of the robust linear fit with clipped errors, so that outliers do not choose terms. The
/// left-out rows choose the terms, so their score is biased. The score of measured_gain is unbiased.
SelectedTerms select_terms(const TermRows& rows, const LinearStructure& structure, const FitOptions& options);

/// Coefficients of linear regressors and terms, with the loss and scale of window fits, (q + T) x n.
Eigen::MatrixXd fit_terms(const TermRows& rows, const LinearStructure& structure, const MotionTerms& terms,
                          const FitOptions& options);

/// The columns of the regression: regressors, then terms.
Eigen::MatrixXd design_of(const TermRows& rows, const LinearStructure& structure, const MotionTerms& terms);

/// Log density of each row's errors (N x n) under a fitted Student t per state, summed over the states.
Eigen::VectorXd student_densities(const Eigen::MatrixXd& errors);

}  // namespace modebank
