#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/bank.hpp"
#include "filter/step/equations/drift_state.hpp"

namespace modebank {

/// One mode that drifts with independent outputs (running_noise.hpp). It has the equations of drift.hpp, but a
/// covariance of r x r per output (or one for all outputs) instead of p x p. h are the regressors [z; v; (1)] of
/// LinearStructure, each divided by its scale:
///   x[k+1] = x[k] + theta[k]' h[k] + e[k],  theta[k] = theta0 + leak (theta[k-1] - theta0) + w[k],  cov(w) = q v W.
/// W = I, or W = d d' if coefficients drift in one direction d. v is the variance of e. In units of v, errors and gains
/// do not depend on v. So one recursion serves every v and all outputs.
///
/// Choices that the method leaves open, with reasons:
/// - The first step after a start uses theta0 with covariance p0 v I, without leak or q.
/// - After a step the coefficients are updated, then the variance, then leak and q. So a sample does not influence
///   its own score.
/// - A step without a measurement also applies leak and q, because time passes. Its prediction replaces the sample.
/// - If some signals of a sample are missing, only the coefficients of the other signals learn. From then on these
///   outputs have a separate P.
/// - If samples are further apart, one step is taken per sample period with the inputs held, as in other banks.
class DriftingRecursion {
 public:
  /// Requires validate(bank) and running noise.
  explicit DriftingRecursion(const Bank& bank);

  void start(const Eigen::Ref<const Eigen::VectorXd>& z);
  /// Advances to the next model step. `inputs`: acting inputs.
  void predict(const Eigen::Ref<const Eigen::VectorXd>& inputs);
  /// For a step without measurement: the prediction becomes the sample.
  void skip();
  /// Updates with a sample. Missing signals are replaced by their predictions.
  void update(const Eigen::Ref<const Eigen::VectorXd>& measured);

  const Eigen::VectorXd& prediction() const { return prediction_; }  ///< n, prediction of the newest sample
  const Eigen::VectorXd& variance() const { return variance_; }      ///< n, variance of the prediction's error
  const Eigen::VectorXd& innovation() const {
    return innovation_;
  }                                                ///< n, innovation of the last update; NaN for missing signals
  const Eigen::VectorXd& z() const { return z_; }  ///< n * state_lags, newest sample first

  /// 1 + h'Ph, the variance of an output's prediction divided by v.
  double growth(Eigen::Index output) const { return growth_(of(output)); }

  DriftState save() const;
  /// `state`: with the sizes of save().
  void restore(const Eigen::Ref<const Eigen::VectorXd>& z, const DriftState& state);

 private:
  LinearStructure structure_;
  DriftRates rates_;
  double keep_;                             ///< lam
  Eigen::VectorXd start_variance_, floor_;  ///< n
  Eigen::VectorXd inverse_scale_;           ///< r
  Eigen::MatrixXd theta0_, direction_;      ///< r x n, for scaled regressors
  Eigen::MatrixXd theta_;                   ///< r x n
  std::vector<Eigen::MatrixXd> P_;          ///< n matrices r x r, lower triangles; the first P_count_ are in use
  std::vector<Eigen::Index> P_of_;          ///< n, index of each output's P
  Eigen::Index P_count_ = 1;                ///< one P is shared by all outputs until a signal is missing
  Eigen::VectorXd z_, v_;
  Eigen::VectorXd h_, prediction_, variance_, innovation_, sample_;
  Eigen::MatrixXd Ph_;      ///< r x n; each P in use has one column
  Eigen::VectorXd growth_;  ///< n; each P in use has one entry

  Eigen::Index of(Eigen::Index output) const { return P_of_[static_cast<std::size_t>(output)]; }
  void own_P();
  void pass_time();
  void split_partial();
  void learn();
  void adapt_variance();
  void push(const Eigen::VectorXd& sample);
};

/// theta, as coefficients of scaled regressors, r x n.
Eigen::MatrixXd scaled_coefficients(const LinearStructure& structure, const Eigen::VectorXd& theta,
                                    const Eigen::VectorXd& scale);
/// The unit direction d in which each output's scaled coefficients drift, r x n: cov(w) = q v d d'. If empty, all
/// coefficients drift: cov(w) = q v I.
Eigen::MatrixXd wandering_direction(const Bank& bank);

}  // namespace modebank
