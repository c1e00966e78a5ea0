#pragma once

#include <Eigen/Core>

#include "ident/fit/options.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/terms.hpp"
#include "ident/terms/term_rows.hpp"

namespace modebank {

/// Terms that a forward selection took, the most telling first.
struct SelectedTerms {
  LinearStructure structure;
  MotionTerms terms;              ///< none where the linear model predicts left-out rows as well
  Eigen::VectorXd left_out = {};  ///< N log densities of rows that did not fit coefficients, all states together
  double log_score() const { return left_out.mean(); }
};

/// Terms of one structure, forward by what they gain on parts of the rows that are left out; as many as leave no more
/// than one standard error to the best count. Coefficients come from Gram matrices without each fold; targets are
/// those of the robust linear fit with errors clipped, so that outliers choose nothing. What is left out has chosen
/// the terms: measured_gain judges them.
SelectedTerms select_terms(const TermRows& rows, const LinearStructure& structure, const FitOptions& options);

/// Coefficients of linear regressors and terms by the loss and the scale of window fits, (q + T) x n.
Eigen::MatrixXd fit_terms(const TermRows& rows, const LinearStructure& structure, const MotionTerms& terms,
                          const FitOptions& options);

/// The columns of these coefficients: regressors and terms.
Eigen::MatrixXd design_of(const TermRows& rows, const LinearStructure& structure, const MotionTerms& terms);

/// Log density of each row's errors (N x n) under a Student t per state that fits them, all states together.
Eigen::VectorXd student_densities(const Eigen::MatrixXd& errors);

}  // namespace modebank
