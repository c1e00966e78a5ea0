#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/drifting_filter.hpp"

namespace modebank {

/// Predicts from the state of a filter with running noise, with known inputs and no further measurements.
///
/// Coefficients in step j + 1: theta0 + leak^j (theta - theta0), with theta at the origin. The first step equals that
/// of the filter. Unstable coefficients are contracted before the second step: A_i (of x[k-i+1], in full form) becomes
/// A_i / rho^i. rho > 1 is the largest modulus of the polynomial's roots, so every root is divided by rho. theta0 is
/// contracted in the same way; otherwise the leak towards theta0 would undo the contraction.
///
/// Variance to first order in the errors of coefficients and samples. e is the error of a sample, and d is the error of
/// theta:
///   e[j] = h[j]' d[j] + phi[j]' (e[j-1], e[j-2], ...) + noise of variance v,
///   d[j] = leak d[j-1] + w,  cov(w) = q v W.
/// phi are the coefficients of the lagged samples. v and the joint covariance of d and the lagged e start with their
/// values at the origin.
///
/// Noise levels (drift.hpp) go on switching: each has its own covariance of the lagged e, and these are mixed
/// before each step, as in the filter. theta has one Gaussian, the mixture of the levels at the origin, so all levels
/// have one mean.
class DriftingForecast {
 public:
  explicit DriftingForecast(DriftingModel model);
  explicit DriftingForecast(const Bank& bank) : DriftingForecast(DriftingModel(bank)) {}

  void start(const DriftingFilter& origin);
  void step(const Eigen::Ref<const Eigen::VectorXd>& inputs);

  const Eigen::VectorXd& prediction() const { return prediction_; }  ///< n
  /// n x n, covariance of the prediction's error, with all levels combined or in one of them.
  Eigen::MatrixXd covariance() const { return state_covariance().topLeftCorner(v_.size(), v_.size()); }
  auto covariance(Eigen::Index level) const {
    return Z_[static_cast<std::size_t>(level)].topLeftCorner(v_.size(), v_.size());
  }
  const Eigen::VectorXd& level_probability() const { return level_; }  ///< J, of the prediction
  Eigen::VectorXd predicted_probability() const { return Eigen::VectorXd::Ones(1); }
  /// The prediction with the preceding samples, and its covariance with the factor of the horizon.
  void merge(Eigen::VectorXd& mean, Eigen::MatrixXd& covariance) const {
    mean = z_;
    covariance = model_.running.factor_at(steps_) * state_covariance();
  }

 private:
  DriftingModel model_;
  Eigen::MatrixXd stable_theta0_;   ///< r x n, coefficients of scaled regressors
  std::vector<Eigen::MatrixXd> P_;  ///< n matrices r x r, covariances of theta at the origin, divided by v
  Eigen::VectorXd v_, level_;       ///< sizes: n, J
  Eigen::VectorXd z_, h_, prediction_;
  Eigen::MatrixXd towards_, deviation_, theta_;         ///< r x n: value towards which coefficients leak, and the
                                                        ///< difference from it
  double of_origin_ = 1.0, of_drift_ = 0.0;             ///< cov(d) / v = of_origin P + of_drift W
  MixingWeights mixing_;                                ///< of the levels
  std::vector<Eigen::MatrixXd> Z_, next_Z_;             ///< per level: covariance of the lagged errors
  std::vector<Eigen::MatrixXd> cross_, next_cross_;     ///< per output r x dimension: covariance of d with the lagged
                                                        ///< errors
  Eigen::MatrixXd covariance_, with_lagged_, through_;  ///< of one level; sizes: n x n, n x dimension, n x dimension
  Eigen::VectorXd of_theta_;                            ///< n, variance of the prediction due to d, divided by v
  Eigen::MatrixXd of_lagged_;                           ///< n x dimension, phi of each output
  Eigen::Index steps_ = 0;

  Eigen::MatrixXd state_covariance() const;
  void merge_levels(const DriftingFilter& origin);
  void mix();
  void pass_time();
  void predict_mean(const Eigen::Ref<const Eigen::VectorXd>& inputs);
  void propagate_errors();
  void propagate_level(std::size_t level);
  void bound();
};

/// Contracts coefficients of scaled regressors (r x n) so that every root of their polynomial lies inside or on the
/// unit circle.
Eigen::MatrixXd contracted(const LinearStructure& structure, const Eigen::VectorXd& scale, Eigen::MatrixXd theta);

}  // namespace modebank
