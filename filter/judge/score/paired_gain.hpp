#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace modebank {

/// What one filter gained over another on the same samples, and how well that is known.
struct PairedGain {
  std::string competitor;
  Eigen::Index samples = 0;     ///< that both scored
  double gain = 0.0;            ///< mean difference of log density [nats/sample]; NaN without samples
  double standard_error = 0.0;  ///< of that mean; NaN where it cannot be known
  double degrees_of_freedom = 0.0;
  double margin = 0.0;     ///< what the gain has to exceed: t(0.975, degrees of freedom) standard errors; NaN likewise
  bool by_blocks = false;  ///< clustered by blocks of samples rather than by runs
  double rank_p = 1.0;     ///< signed_rank_p of the mean differences of runs, or of blocks side by side

  /// False where the error is not known.
  bool exceeds() const { return gain > margin; }
  bool ranks_tell() const { return rank_p < 0.05; }
  /// By the paired t-test, one-sided at 2.5 %, and by the signed ranks, one-sided at 5 %: one odd run ruins the former.
  bool told() const { return exceeds() && ranks_tell(); }
  bool falls_short() const { return gain < -margin; }
};

/// `better`, `other`: log densities of each run's samples [nats], NaN where there is none; only samples that both have
/// count. Standard error of the mean m of N differences d clustered by run r of n_r samples and sum d_r,
///   SE^2 = G / (G - 1) sum_r (d_r - m n_r)^2 / N^2,   df = G - 1
/// (linearised ratio: Cochran 1977, section 6.3). Below five runs the clusters are moving blocks inside runs (Kuensch
/// 1989, Annals of Statistics 17), of at least two autocorrelation times of the differences:
///   SE^2 = B / (B - 1) mean_i (S_i - b m)^2 / (b N),   df = B - 1,
/// S_i the sum over block i of b samples, B how many fit side by side. Below eight the error is not known (NaN).
PairedGain paired_gain(const std::string& competitor, const std::vector<Eigen::VectorXd>& better,
                       const std::vector<Eigen::VectorXd>& other);

}  // namespace modebank
