#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace modebank {

/// Gain of one filter over another on the same samples, and its uncertainty.
struct PairedGain {
  std::string competitor;
  Eigen::Index samples = 0;     ///< number of samples that both filters scored
  double gain = 0.0;            ///< mean difference of log density [nats/sample]; NaN without samples
  double standard_error = 0.0;  ///< standard error of the gain; NaN if unknown
  double degrees_of_freedom = 0.0;
  double margin = 0.0;     ///< smallest significant gain: t(0.975, degrees of freedom) times the standard error; NaN if
                           ///< unknown
  bool by_blocks = false;  ///< whether clusters are blocks of samples instead of runs
  double rank_p = 1.0;     ///< signed_rank_p of the mean differences per run, or per block of samples

  /// False if the standard error is unknown.
  bool exceeds() const { return gain > margin; }
  bool ranks_tell() const { return rank_p < 0.05; }
  /// Whether the gain is significant by two tests: the paired t-test (one-sided at 2.5 %) and signed ranks (one-sided
  /// at 5 %). The second test is needed because a single unusual run can distort the t-test.
  bool told() const { return exceeds() && ranks_tell(); }
  bool falls_short() const { return gain < -margin; }
};

/// Computes the gain. `better`, `other`: log densities of each run's samples [nats], NaN if missing. Only samples with
/// both densities are used. The standard error of the mean m of N differences d is clustered by run r, with n_r samples
/// and sum d_r (linearised ratio: Cochran 1977, section 6.3):
///   SE^2 = G / (G - 1) sum_r (d_r - m n_r)^2 / N^2,   df = G - 1. With fewer than five runs the clusters are moving
///   blocks inside runs (Kuensch 1989, Annals of Statistics 17), at least two autocorrelation times of the differences
///   long:
///   SE^2 = B / (B - 1) mean_i (S_i - b m)^2 / (b N),   df = B - 1. S_i is the sum over block i of b samples, B the
///   number of blocks that fit side by side. With fewer than eight blocks the error is unknown (NaN).
PairedGain paired_gain(const std::string& competitor, const std::vector<Eigen::VectorXd>& better,
                       const std::vector<Eigen::VectorXd>& other);

/// One-sided p value of Wilcoxon's signed-rank test (1945, Biometrics Bulletin 1(6)). If differences are symmetric
/// about zero, a rank sum is at least as large as here with this probability. Exact up to 50 differences, with shared
/// ranks for equal sizes. With more differences, the normal approximation is used. Zeros are ignored. 1 if all
/// differences are zero.
double signed_rank_p(const std::vector<double>& differences);

}  // namespace modebank
