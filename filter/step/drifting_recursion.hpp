#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/bank.hpp"
#include "filter/step/equations/drift_state.hpp"

namespace modebank {

/// One mode of a bank that drifts, where outputs are independent (running_noise.hpp): the equations of drift.hpp with a
/// covariance of r x r for each output, or one for all, in place of one of p x p. With h the regressors [z; v; (1)] of
/// LinearStructure, each over its scale,
///   x[k+1] = x[k] + theta[k]' h[k] + e[k],  theta[k] = theta0 + leak (theta[k-1] - theta0) + w[k],  cov(w) = q v W,
/// W = I, or d d' of the direction that wanders. In units of the variance v of e neither errors nor gains depend on v,
/// so this recursion serves every v, and all outputs together.
///
/// What the method leaves open, and why it is so here:
/// - The first step after a start has the coefficients theta0 with covariance p0 v I themselves: no leak, no q yet.
/// - After a step come coefficients, variance, then leak and q: a sample is scored by nothing that it had a part in.
/// - A step without a measurement leaks and adds q, too: time passes. Its prediction stands in for the sample.
/// - Where some signals of a sample are missing the others' coefficients learn alone; P is then their own from there
/// on.
/// - Between samples further apart a step is taken per sample period with the inputs held, as banks do.
class DriftingRecursion {
 public:
  /// Requires validate(bank), running noise.
  explicit DriftingRecursion(const Bank& bank);

  void start(const Eigen::Ref<const Eigen::VectorXd>& z);
  /// To the next model step; `inputs`: those that act on it.
  void predict(const Eigen::Ref<const Eigen::VectorXd>& inputs);
  /// Nothing was measured: the prediction is the sample.
  void skip();
  /// Takes the sample in; what is missing of it is the prediction.
  void update(const Eigen::Ref<const Eigen::VectorXd>& measured);

  const Eigen::VectorXd& prediction() const { return prediction_; }  ///< n, of the newest sample
  const Eigen::VectorXd& variance() const { return variance_; }      ///< n, of its error
  const Eigen::VectorXd& innovation() const { return innovation_; }  ///< n, of the last update; NaN where missing
  const Eigen::VectorXd& z() const { return z_; }                    ///< n * state_lags, newest sample first
  /// 1 + h'Ph, the variance of an output's prediction over v.
  double growth(Eigen::Index output) const { return growth_(of(output)); }

  DriftState save() const;
  /// `state`: of the sizes of save().
  void restore(const Eigen::Ref<const Eigen::VectorXd>& z, const DriftState& state);

 private:
  LinearStructure structure_;
  DriftRates rates_;
  double keep_;                             ///< lam
  Eigen::VectorXd start_variance_, floor_;  ///< n
  Eigen::VectorXd inverse_scale_;           ///< r
  Eigen::MatrixXd theta0_, direction_;      ///< r x n, of scaled regressors
  Eigen::MatrixXd theta_;                   ///< r x n
  std::vector<Eigen::MatrixXd> P_;          ///< n of r x r, lower triangles; the first P_count_ are in use
  std::vector<Eigen::Index> P_of_;          ///< n, which of them an output's is
  Eigen::Index P_count_ = 1;                ///< one serves all until a signal is missing
  Eigen::VectorXd z_, v_;
  Eigen::VectorXd h_, prediction_, variance_, innovation_, sample_;
  Eigen::MatrixXd Ph_;      ///< r x n, one column per P in use
  Eigen::VectorXd growth_;  ///< n, one per P in use

  Eigen::Index of(Eigen::Index output) const { return P_of_[static_cast<std::size_t>(output)]; }
  void own_P();
  void pass_time();
  void split_partial();
  void learn();
  void adapt_variance();
  void push(const Eigen::VectorXd& sample);
};

/// theta as coefficients of scaled regressors, r x n.
Eigen::MatrixXd scaled_coefficients(const LinearStructure& structure, const Eigen::VectorXd& theta,
                                    const Eigen::VectorXd& scale);
/// The direction d of unit length in which each output's scaled coefficients wander, r x n: cov(w) = q v d d'. Empty
/// where all wander: cov(w) = q v I.
Eigen::MatrixXd wandering_direction(const Bank& bank);

}  // namespace modebank
