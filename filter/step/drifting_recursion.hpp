#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "filter/step/bank.hpp"
#include "filter/step/equations/imm.hpp"
#include "filter/step/student_noise.hpp"

namespace modebank {

/// One mode that drifts with independent outputs. h are the regressors [z; v; (1)] of LinearStructure, each divided by
/// its scale:
///   x[k+1] = x[k] + theta[k]' h[k] + e[k],  theta[k] = theta0 + leak (theta[k-1] - theta0) + w[k],  cov(w) = q v W.
/// W = I, or W = d d' if coefficients drift in one direction d. The variance of e is v times the present noise level.
/// In units of v, errors and gains do not depend on v. So with one level one recursion serves every v and all outputs.
///
/// With several levels this is an interacting multiple model filter (equations/imm.hpp): one Gaussian of theta per
/// level. Levels start with the stationary distribution of T.
///
/// Choices that the method leaves open, with reasons:
/// - The first step after a start uses theta0 with covariance p0 v I, without leak or q.
/// - After a step the coefficients are updated, then the variance, then leak and q. So a sample does not influence
///   its own score.
/// - A step without a measurement also applies leak and q, because time passes. Its prediction replaces the sample.
/// - If some signals of a sample are missing, only the coefficients of the other signals learn. From then on these
///   outputs have a separate P.
/// - If samples are further apart, one step is taken per sample period with the inputs held, as in other banks.
/// - The variance of a level is at least quantum^2 / 12, that of rounding.
class DriftingRecursion {
 public:
  /// Requires validate(bank) and running noise.
  explicit DriftingRecursion(const Bank& bank);

  void start(const Eigen::Ref<const Eigen::VectorXd>& z);
  /// Advances to the next model step. `inputs`: acting inputs.
  void predict(const Eigen::Ref<const Eigen::VectorXd>& inputs);
  /// For a step without measurement: the prediction becomes the sample.
  void skip();
  /// Updates with a sample. Missing signals are replaced by their predictions. Returns the log density of the available
  /// signals; NaN if there are none. For quantised outputs it is log (mass of the interval / q).
  double update(const Eigen::Ref<const Eigen::VectorXd>& measured);

  const Eigen::VectorXd& prediction() const { return prediction_; }  ///< n, prediction of the newest sample
  const Eigen::VectorXd& variance() const { return variance_; }      ///< n, variance of the prediction's error
  const Eigen::VectorXd& innovation() const {
    return innovation_;
  }                                                ///< n, innovation of the last update; NaN for missing signals
  const Eigen::VectorXd& z() const { return z_; }  ///< n * state_lags, newest sample first

  /// P(output <= measured value + away) before the last update. `weight`: probabilities of the levels, J.
  double probability(Eigen::Index output, double away, const Eigen::Ref<const Eigen::VectorXd>& weight) const;
  /// Probabilities of the levels (J), given what came before the last update and its first `outputs` outputs. Returns
  /// the log density of these outputs.
  double weigh_levels(Eigen::Index outputs, Eigen::VectorXd& weight) const;

  const Eigen::VectorXd& quantum() const { return quantum_; }  ///< n, quanta; 0 for a continuous signal
  /// s + h'Ph of the first level, the variance of an output's prediction divided by v.
  double growth(Eigen::Index output) const { return growth_(of(output)); }

  DriftState save() const;
  /// `state`: with the sizes of save().
  void restore(const Eigen::Ref<const Eigen::VectorXd>& z, const DriftState& state);

 private:
  LinearStructure structure_;
  DriftRates rates_;
  RunningNoise running_;
  StudentNoise noise_;
  Eigen::VectorXd quantum_, rounding_;        ///< n, quanta and variances of rounding
  Eigen::VectorXd start_variance_;            ///< n
  Eigen::VectorXd start_level_;               ///< J
  Eigen::VectorXd inverse_scale_;             ///< r
  Eigen::MatrixXd theta0_, direction_;        ///< r x n, for scaled regressors
  Eigen::MatrixXd theta_, mixed_theta_;       ///< r x J n: output i of level j has column j n + i
  std::vector<Eigen::MatrixXd> P_, mixed_P_;  ///< J n matrices r x r, lower triangles; of each level's n matrices the
                                              ///< first P_count_ are in use
  std::vector<Eigen::Index> P_of_;            ///< n, index of each output's P
  Eigen::Index P_count_ = 1;                  ///< one P is shared by all outputs until a signal is missing
  Eigen::VectorXd z_, v_;
  Eigen::VectorXd level_, predicted_level_;  ///< J, probabilities of the levels after and before the last update
  MixingWeights mixing_;                     ///< of the levels
  Eigen::VectorXd h_, prediction_, variance_, innovation_, sample_, deviation_;
  Eigen::MatrixXd Ph_;                         ///< r x J n; each P in use has one column
  Eigen::VectorXd growth_;                     ///< J n; each P in use has one entry
  Eigen::MatrixXd of_level_, error_, spread_;  ///< n x J: predictions, errors, and standard deviations of each level

  Eigen::Index of(Eigen::Index output) const { return P_of_[static_cast<std::size_t>(output)]; }
  bool switches() const { return running_.level.size() > 0; }
  Eigen::Index levels() const { return level_.size(); }
  Eigen::Index at(Eigen::Index level, Eigen::Index output) const { return level * structure_.states + output; }
  Eigen::MatrixXd& P(Eigen::Index level, Eigen::Index group) { return P_[static_cast<std::size_t>(at(level, group))]; }
  void own_P();
  void mix();
  void mix_output(Eigen::Index level, Eigen::Index output);
  void predict_level(Eigen::Index level);
  void pass_time();
  void split_partial();
  double log_density(Eigen::Index output, Eigen::Index level) const;
  void learn();
  void adapt_variance();
  void push(const Eigen::VectorXd& sample);
};

/// Variance of an output's noise in a level, in units of v. `rounding`: that of rounding, which v itself contains if
/// there is one level.
inline double level_variance(const RunningNoise& noise, Eigen::Index output, Eigen::Index j, double rounding) {
  if (noise.levels() == 1) return noise.level.size() == 0 ? 1.0 : noise.level(output, 0);
  return std::max(noise.level(output, j), rounding);
}

/// theta, as coefficients of scaled regressors, r x n.
Eigen::MatrixXd scaled_coefficients(const LinearStructure& structure, const Eigen::VectorXd& theta,
                                    const Eigen::VectorXd& scale);
/// The unit direction d in which each output's scaled coefficients drift, r x n: cov(w) = q v d d'. If empty, all
/// coefficients drift: cov(w) = q v I.
Eigen::MatrixXd wandering_direction(const Bank& bank);

}  // namespace modebank
