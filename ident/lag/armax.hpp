#pragma once

#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/lag/structure.hpp"
#include "ident/lag/structure_scorer.hpp"

namespace modebank {

/// Runs one after the other, one column per sample: levels about their means, or differences.
struct ArmaxSamples {
  Eigen::MatrixXd y, u;
  std::vector<Index> rows = {};       ///< samples that are predicted; no lag of theirs is missing or before a gap
  std::vector<Index> long_rows = {};  ///< samples that a long ARX predicts: some more at the start of each stretch
  StretchParts parts = {};            ///< of the rows
  bool differences = false;
  Eigen::MatrixXd residuals = {};  ///< of the long ARX

  Index count() const { return std::ssize(rows); }
};

/// Residuals of a long ARX (20 lags of states, 30 of inputs). They serve as noise before any model is known.
void add_residuals(ArmaxSamples& samples, const std::vector<Index>& least_delay);

/// A fit by prediction errors (Ljung 1999, section 7.2), started by Hannan & Rissanen (1982).
struct ArmaxFit : ArmaxStructure {
  Eigen::MatrixXd theta;       ///< n x P: state lags (n columns each), input lags (m columns each), the constant
  Eigen::MatrixXd C;           ///< n columns for each lag
  Eigen::MatrixXd S;           ///< n x n, covariance of e
  Eigen::MatrixXd covariance;  ///< of the entries of [theta C], row by row
  Index rows = 0;              ///< number of samples predicted
  LeftOutForecast left_out = {};
  Index size() const { return theta.size() + C.size(); }
};

/// At most 15 Gauss-Newton steps with halving, Huber's weights, roots of C within .995. Errors before the start of a
/// stretch are unknown. `leave_out`: whether each fifth of the parts is predicted without it.
ArmaxFit fit_armax(const ArmaxSamples& samples, const ArmaxStructure& structure, bool leave_out);

/// S by least squares (Hannan & Rissanen), with the long ARX's residuals as noise.
Eigen::MatrixXd least_squares_covariance(const ArmaxSamples& samples, const ArmaxStructure& structure);

}  // namespace modebank
