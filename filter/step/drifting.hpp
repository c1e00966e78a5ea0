#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "filter/step/bank.hpp"
#include "filter/step/imm.hpp"
#include "filter/step/noise_density.hpp"
#include "filter/step/samples.hpp"

namespace modebank {

class DriftingForecast;

/// A bank with one mode that drifts, in the layout for stepping.
struct DriftingModel {
  LinearStructure structure;
  DriftRates rates;
  RunningNoise running;
  Eigen::VectorXd rounding;              ///< n, variance of rounding
  Eigen::VectorXd scale, inverse_scale;  ///< r
  Eigen::MatrixXd theta0;                ///< r x n, coefficients of scaled regressors

  explicit DriftingModel(const Bank& bank);

  bool switches() const { return running.level.size() > 0; }
  /// Variance of an output's noise in a level, in units of its v, which contains the rounding if there is one level.
  double level_variance(Eigen::Index output, Eigen::Index level, double v) const {
    if (running.levels() == 1) return switches() ? running.level(output, 0) : 1.0;
    return std::max(running.level(output, level), rounding(output) / v);
  }
  /// The scaled regressors h of the step from z.
  void fill(const Eigen::VectorXd& z, const Eigen::Ref<const Eigen::VectorXd>& inputs, Eigen::VectorXd& h) const {
    fill_regressor(structure, z, inputs, h);
    h.array() *= inverse_scale.array();
  }
  /// Makes `sample` the newest one of z.
  void push(const Eigen::VectorXd& sample, Eigen::VectorXd& z) const {
    for (Eigen::Index i = z.size() - 1; i >= sample.size(); --i) z(i) = z(i - sample.size());
    z.head(sample.size()) = sample;
  }
};

/// The filter of a bank with one mode that drifts, with independent outputs and RunningNoise (bank.hpp). h are the
/// regressors [z; v; (1)] of LinearStructure, each divided by its scale:
///   x[k+1] = x[k] + theta[k]' h[k] + e[k],  theta[k] = theta0 + leak (theta[k-1] - theta0) + w[k],  cov(w) = q v I.
/// With several levels this is an interacting multiple model filter (imm.hpp): one Gaussian of theta per level. Levels
/// start with the stationary distribution of T.
///
/// The state is z with the newest measured value. State covariances are zero; the innovation covariance is diagonal.
///
/// Choices that the method leaves open, with reasons:
/// - The first step after a start uses theta0 with covariance p0 v I, without leak or q.
/// - After a step the coefficients are updated, then the variance, then leak and q. So a sample does not influence
///   its own score.
/// - A step without a measurement also applies leak and q, because time passes. Its prediction replaces the sample.
/// - If some signals of a sample are missing, only the coefficients of the other signals learn.
class DriftingFilter {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  /// Requires validate(bank) and running noise.
  explicit DriftingFilter(const Bank& bank);

  // As in ImmFilter.
  void start(const Vector& z);
  void predict(const Vector& inputs);
  void step(const Vector& inputs);
  /// Missing signals are replaced by their predictions. For quantised outputs: log (mass of the interval / q).
  double update(const Vector& measured);
  void combine(Eigen::VectorXd& state, Eigen::MatrixXd& innovation_covariance) const;
  void transform(const Vector& y, Eigen::VectorXd& pit, Eigen::VectorXd& width, double& log_density);
  void merge(Eigen::VectorXd& mean, Eigen::MatrixXd& covariance) const {
    mean = z_;
    covariance.setZero();
  }
  const Eigen::VectorXd& predicted_probability() const { return one_; }
  const Eigen::VectorXd& mode_probability() const { return one_; }
  DriftingForecast forecast() const;
  std::vector<SnapshotPart> parts() {
    return {numbers_of(z_), numbers_of(theta_), numbers_of(P_), numbers_of(v_), numbers_of(level_)};
  }
  void settle() const;

  const Eigen::VectorXd& z() const { return z_; }                    ///< n * state_lags, newest sample first
  const Eigen::MatrixXd& theta() const { return theta_; }            ///< r x J n: level j has the columns from j n on
  const Eigen::VectorXd& variance() const { return v_; }             ///< n, running variance v
  const Eigen::VectorXd& level() const { return level_; }            ///< J, probabilities of the levels
  const Eigen::VectorXd& innovation() const { return innovation_; }  ///< n, of the last update; NaN where missing
  /// r x r (lower triangle), covariance of an output's coefficients in a level, divided by v.
  auto P(Eigen::Index level, Eigen::Index output) const {
    return P_.middleCols(at(level, output) * P_.rows(), P_.rows());
  }
  /// s + h'Ph of the first level, the variance of an output's prediction divided by v.
  double growth(Eigen::Index output) const { return growth_(output, 0); }
  /// P(output <= measured value + away) before the last update. `weight`: probabilities of the levels, J.
  double probability(Eigen::Index output, double away, const Vector& weight) const;
  /// Probabilities of the levels (J) after the first `outputs` outputs of the last update. Returns their log density.
  double weigh_levels(Eigen::Index outputs, Eigen::VectorXd& weight) const;

 private:
  DriftingModel model_;
  StudentNoise noise_;
  Eigen::VectorXd quantum_;                       ///< n; 0 for a continuous signal
  Eigen::VectorXd start_variance_, start_level_;  ///< n, J
  Eigen::MatrixXd theta_, mixed_theta_, P_, mixed_P_;
  Eigen::VectorXd z_, v_, level_, predicted_level_;  ///< the levels after and before the last update
  MixingWeights mixing_;                             ///< of the levels
  Eigen::VectorXd h_, prediction_, variance_, innovation_, sample_, deviation_, weight_;
  Eigen::MatrixXd Ph_;                                  ///< r x J n
  Eigen::MatrixXd growth_, of_level_, error_, spread_;  ///< n x J: s + h'Ph, predictions, errors, standard deviations
  Eigen::VectorXd one_ = Eigen::VectorXd::Ones(1);

  Eigen::Index levels() const { return level_.size(); }
  Eigen::Index at(Eigen::Index level, Eigen::Index output) const { return level * model_.structure.states + output; }
  /// The same of a matrix like P_, to be changed.
  auto part(Eigen::MatrixXd& all, Eigen::Index level, Eigen::Index output) const {
    return all.middleCols(at(level, output) * all.rows(), all.rows());
  }
  void mix();
  void pass_time();
  double log_density(Eigen::Index output, Eigen::Index level) const;
};

/// Predicts from the state of a DriftingFilter, with known inputs and no further measurements. Coefficients in step
/// j + 1: theta0 + leak^j (theta - theta0), with theta at the origin. Unstable coefficients are contracted before the
/// second step: A_i (of x[k-i+1], in full form) becomes A_i / rho^i. rho > 1 is the largest modulus of the polynomial's
/// roots. So is theta0; otherwise the leak towards theta0 would undo the contraction.
///
/// Variance to first order in the errors e of samples and d of theta:
///   e[j] = h[j]' d[j] + phi[j]' (e[j-1], e[j-2], ...) + noise of variance v,
///   d[j] = leak d[j-1] + w,  cov(w) = q v I.
/// phi are the coefficients of the lagged samples. Noise levels go on switching: each has its own covariance of the
/// lagged e, and these are mixed before each step, as in the filter. theta has one Gaussian, the mixture of the levels
/// at the origin, so all levels have one mean.
class DriftingForecast {
 public:
  explicit DriftingForecast(DriftingModel model);
  explicit DriftingForecast(const Bank& bank) : DriftingForecast(DriftingModel(bank)) {}

  void start(const DriftingFilter& origin);
  void step(const Eigen::Ref<const Eigen::VectorXd>& inputs);

  const Eigen::VectorXd& prediction() const { return prediction_; }  ///< n
  /// n x n, covariance of the prediction's error, with all levels combined or in one of them.
  Eigen::MatrixXd covariance() const { return state_covariance().topLeftCorner(v_.size(), v_.size()); }
  auto covariance(Eigen::Index level) const { return Z_.block(0, level * Z_.rows(), v_.size(), v_.size()); }
  const Eigen::VectorXd& level_probability() const { return level_; }  ///< J, of the prediction
  Eigen::VectorXd predicted_probability() const { return Eigen::VectorXd::Ones(1); }
  /// The prediction with the preceding samples, and its covariance with the factor of the horizon.
  void merge(Eigen::VectorXd& mean, Eigen::MatrixXd& covariance) const {
    mean = z_;
    covariance = model_.running.factor_at(steps_) * state_covariance();
  }

 private:
  DriftingModel model_;
  Eigen::MatrixXd stable_theta0_;  ///< r x n, coefficients of scaled regressors
  Eigen::MatrixXd P_;              ///< r x n r, covariances of each output's theta at the origin, divided by v
  Eigen::VectorXd v_, level_;      ///< sizes: n, J
  Eigen::VectorXd z_, h_, prediction_;
  Eigen::MatrixXd towards_, deviation_, theta_;  ///< r x n: value towards which coefficients leak, difference
  double of_origin_ = 1.0, of_drift_ = 0.0;      ///< cov(d) / v = of_origin P + of_drift I
  MixingWeights mixing_;                         ///< of the levels
  Eigen::MatrixXd Z_, next_Z_;                   ///< dimension x J dimension, per level: cov of the lagged errors
  Eigen::MatrixXd cross_, next_cross_;           ///< r x n dimension, per output: cov of d with the lagged errors
  Eigen::MatrixXd covariance_, with_lagged_, through_;  ///< of one level; sizes: n x n, n x dimension, n x dimension
  Eigen::VectorXd of_theta_;                            ///< n, variance of the prediction due to d, divided by v
  Eigen::MatrixXd of_lagged_;                           ///< n x dimension, phi of each output
  Eigen::Index steps_ = 0;

  Eigen::MatrixXd state_covariance() const;
  void mix();
  void propagate_theta();
  void propagate_levels();
  void bound();
};

/// Contracts coefficients of scaled regressors (r x n) until no root of their polynomial lies outside the unit circle.
Eigen::MatrixXd contracted(const LinearStructure& structure, const Eigen::VectorXd& scale, Eigen::MatrixXd theta);

}  // namespace modebank
