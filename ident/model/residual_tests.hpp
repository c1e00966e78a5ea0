#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

struct ResidualTestOptions {
  Index lags = 25;      ///< lags 0 .. lags, fewer for a series that is shorter
  double level = 0.99;  ///< of the confidence bands, two-sided and for each lag on its own
};

/// Whether a model's residuals are white and uncorrelated with its inputs, as they are when it has left nothing to
/// explain. T = lags + 1; column tau holds lag tau.
struct ResidualTests {
  Index samples = 0;                  ///< N, samples whose residuals are all finite
  Eigen::MatrixXd autocorrelation;    ///< n x T, of each state's residual with itself tau samples earlier; 1 at lag 0
  Eigen::MatrixXd cross_correlation;  ///< n*m x T, row i m + j: residual i with input j tau samples earlier
  double level = 0.99;
  double autocorrelation_band = 0.0;       ///< white residuals lie within +- this at lags 1, 2, ...
  Eigen::MatrixXd cross_correlation_band;  ///< m x n, entry (j, i) for residual i and input j
  Eigen::VectorXd ljung_box_p;             ///< n, p values of "no autocorrelation" over min(lags, N / 5) lags

  Index states() const { return autocorrelation.rows(); }
  /// Shares of the lags outside their bands (1 - level is expected of an adequate model): of the autocorrelations at
  /// lags 1 .. lags, and of the cross-correlations at lags 0 .. lags. NaN when none is defined.
  double autocorrelation_outside() const;
  double cross_correlation_outside() const;
};

/// Portmanteau test of Ljung & Box (1978), Biometrika 65(2): p value of "no autocorrelation" of N samples from their
/// autocorrelation at lags 0, 1, ..., of which at most N / 5 count, each a degree of freedom. NaN without a lag to
/// count or for a series that is constant.
double ljung_box_p(const Eigen::VectorXd& autocorrelation, Index N);

/// `residual` n x N, `input` m x N, column k of both of the same step; a residual that responds to input j with a delay
/// of d steps that the model does not know shows at lag d. Correlations are about the mean with divisor N (Box &
/// Jenkins 1976); samples that are not finite are left out of the sums. A constant series has NaN.
///
/// Bands, z = Phi^-1((1 + level) / 2): z / sqrt(N) for autocorrelations of white residuals (near lag 0 those of a
/// fitted model vary less: Box & Pierce 1970), and z sqrt(P / N) for cross-correlations of independent residuals and
/// inputs, P = sum over k of rho_residual(k) rho_input(k) (Bartlett 1955; Soderstrom & Stoica 1989, section 11.2; Ljung
/// 1999, section 16.6), here over |k| <= lags with the weights 1 - |k| / (lags + 1), which keep P positive. Throws
/// std::invalid_argument for sizes and options that do not fit.
ResidualTests test_residuals(const Eigen::MatrixXd& residual, const Eigen::MatrixXd& input,
                             const ResidualTestOptions& options = {});

/// The same of a model's one-step residuals x[k+1] - x[k] - [A B c] phi_k over one run, of whatever role, with the
/// inputs u[k].
ResidualTests test_residuals(const Trajectory& run, const LinearStructure& structure, const Eigen::VectorXd& theta,
                             const ResidualTestOptions& options = {});

/// Mean shares outside the bands over several runs' tests, where they are defined; NaN where none is.
struct ResidualSummary {
  double autocorrelation_outside = 0.0;
  double cross_correlation_outside = 0.0;
};
ResidualSummary summarize(const std::vector<ResidualTests>& runs);

}  // namespace modebank
