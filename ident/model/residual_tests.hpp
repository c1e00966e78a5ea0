#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

struct ResidualTestOptions {
  Index lags = 25;      ///< lags 0 .. lags are tested; for shorter series fewer lags
  double level = 0.99;  ///< level of the confidence bands, two-sided, for each lag separately
};

/// Tests whether a model's residuals are white, and uncorrelated with the inputs. Both hold if the model explains
/// everything. T = lags + 1; column tau holds lag tau.
struct ResidualTests {
  Index samples = 0;                  ///< N, number of samples with finite residuals
  Eigen::MatrixXd autocorrelation;    ///< n x T, correlation of each state's residual with itself tau samples earlier;
                                      ///< 1 at lag 0
  Eigen::MatrixXd cross_correlation;  ///< n*m x T, row i m + j: correlation of residual i with input j tau samples
                                      ///< earlier
  double level = 0.99;
  double autocorrelation_band = 0.0;       ///< band of white residuals at lags 1, 2, ...: from minus to plus this value
  Eigen::MatrixXd cross_correlation_band;  ///< m x n, entry (j, i): half width of the band for residual i and input j
  Eigen::VectorXd ljung_box_p;             ///< n, p values of the hypothesis of no autocorrelation, over min(lags, N /
                                           ///< 5) lags

  Index states() const { return autocorrelation.rows(); }
};

/// Portmanteau test of Ljung & Box (1978), Biometrika 65(2): p value of the hypothesis of no autocorrelation. Inputs
/// are the autocorrelations of N samples at lags 0, 1, ... At most N / 5 lags are used, each with one degree of
/// freedom. NaN without usable lags or for a constant series.
double ljung_box_p(const Eigen::VectorXd& autocorrelation, Index N);

/// Tests `residual` (n x N) against `input` (m x N). Column k of both belongs to the same step. If the residual reacts
/// to input j with an unmodelled delay of d steps, the correlation at lag d is large. Correlations are about the mean,
/// with divisor N (Box & Jenkins 1976). Samples that are not finite are ignored. A constant series gives NaN.
///
/// Bands with z = Phi^-1((1 + level) / 2): z / sqrt(N) for autocorrelations of white residuals. (Near lag 0 the
/// autocorrelations of a fitted model vary less: Box & Pierce 1970.) For cross-correlations of independent residuals
/// and inputs: z sqrt(P / N) with P = sum over k of rho_residual(k) rho_input(k) (Bartlett 1955; Soderstrom & Stoica
/// 1989, section 11.2; Ljung 1999, section 16.6). Here |k| <= lags with the weights 1 - |k| / (lags + 1), which keep P
/// positive. Throws std::invalid_argument for sizes and options that do not fit.
ResidualTests test_residuals(const Eigen::MatrixXd& residual, const Eigen::MatrixXd& input,
                             const ResidualTestOptions& options = {});

/// test_residuals for the one-step residuals x[k+1] - x[k] - [A B c] phi_k of a model over one run, against the inputs
/// u[k]. The run may be a training or a held-out run.
ResidualTests test_residuals(const Trajectory& run, const LinearStructure& structure, const Eigen::VectorXd& theta,
                             const ResidualTestOptions& options = {});

}  // namespace modebank
