#pragma once

#include <vector>

#include "ident/lag/armax.hpp"

namespace modebank {

/// A stretch without gaps: levels about the training means or differences, one column per sample.
struct ArmaxStretch {
  Eigen::MatrixXd y, u;
  Eigen::MatrixXd residuals;  ///< of a long ARX; zero before its first row
  Index part = 0;             ///< what is left out together
};

struct ArmaxData {
  std::vector<ArmaxStretch> stretches;
  bool differences = false;
  std::vector<Index> delays = {};            ///< m, found for these data
  Index first = 0;                           ///< first sample of a stretch that is predicted
  std::vector<Index> begin = {}, rows = {};  ///< first row of each stretch in all rows, and number of rows
  Index count = 0;                           ///< number of all rows

  Index states() const { return stretches.front().y.rows(); }
  Index inputs() const { return stretches.front().u.rows(); }
};

/// Sum of z z' over samples from `first` on. z: state lags, input lags, the constant, lagged residuals, the n targets.
Eigen::MatrixXd armax_gram(const ArmaxData& data, const ArmaxOrder& order, const std::vector<Index>& delays,
                           Index first);

/// xx^-1 xz for scaled columns. Directions that rounding explains are left at zero.
Eigen::MatrixXd solve_scaled(const Eigen::MatrixXd& xx, const Eigen::MatrixXd& xz);

/// Sets residuals to those of a long ARX, which serve as noise before any model is known.
void add_residuals(ArmaxData& data, const std::vector<Index>& least_delay);

/// Of stretches whose fold was left out.
struct LeftOut {
  Eigen::MatrixXd errors;      ///< n x rows
  Eigen::VectorXd start_nats;  ///< what residuals unknown before the start of each stretch take from the likelihood
};

/// At most 15 Gauss-Newton steps with halving. `left_out`, if not null, is made by one further step from the fit
/// without the sums of the fold.
ArmaxFit fit_armax(const ArmaxData& data, const ArmaxOrder& order, const std::vector<Index>& delays,
                   LeftOut* left_out = nullptr);

}  // namespace modebank
