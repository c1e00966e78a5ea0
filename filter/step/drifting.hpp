#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <tuple>
#include <vector>

#include "filter/step/bank.hpp"
#include "filter/step/imm.hpp"
#include "filter/step/noise_density.hpp"

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
  /// The unit direction d in which each output's scaled coefficients drift, r x n: cov(w) = q v d d'. If empty, all
  /// coefficients drift: cov(w) = q v I.
  Eigen::MatrixXd direction;

  explicit DriftingModel(const Bank& bank);

  bool switches() const { return running.level.size() > 0; }
  /// Variance of an output's noise in a level, in units of its `v`. v itself contains the rounding if there is one
  /// level.
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

/// The filter of a bank with one mode that drifts, with independent outputs and running noise. h are the regressors
/// [z; v; (1)] of LinearStructure, each divided by its scale:
///   x[k+1] = x[k] + theta[k]' h[k] + e[k],  theta[k] = theta0 + leak (theta[k-1] - theta0) + w[k],  cov(w) = q v W.
/// W = I, or W = d d' if coefficients drift in one direction d. The variance of e is v times the present noise level.
///
/// With several levels this is an interacting multiple model filter (imm.hpp): one Gaussian of theta per
/// level. Levels start with the stationary distribution of T.
///
/// The state is z with the newest measured value (or the prediction if it is missing). State covariances are zero; the
/// innovation covariance is diagonal. pit uses Student's distribution, output by output (Rosenblatt 1952) where the
/// noise has several levels.
///
/// Choices that the method leaves open, with reasons:
/// - The first step after a start uses theta0 with covariance p0 v I, without leak or q.
/// - After a step the coefficients are updated, then the variance, then leak and q. So a sample does not influence
///   its own score.
/// - A step without a measurement also applies leak and q, because time passes. Its prediction replaces the sample.
/// - If some signals of a sample are missing, only the coefficients of the other signals learn.
/// - If samples are further apart, one step is taken per sample period with the inputs held, as in other banks.
/// - The variance of a level is at least quantum^2 / 12, that of rounding.
class DriftingFilter {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  /// Requires validate(bank) and running noise.
  explicit DriftingFilter(const Bank& bank);

  // As in ImmFilter.
  void start(const Vector& z);
  void predict(const Vector& inputs);
  void step(const Vector& inputs);
  /// Missing signals are replaced by their predictions. For quantised outputs the result is log (mass of the interval /
  /// q).
  double update(const Vector& measured);
  void combine(Eigen::VectorXd& state, Eigen::MatrixXd& innovation_covariance) const;
  void transform(const Vector& y, Eigen::VectorXd& pit, Eigen::VectorXd& width, double& log_density);
  void merge(Eigen::VectorXd& mean, Eigen::MatrixXd& covariance) const;
  const Eigen::VectorXd& predicted_probability() const { return one_; }
  const Eigen::VectorXd& mode_probability() const { return one_; }
  DriftingForecast forecast() const;
  auto parts() { return std::tie(z_, theta_, P_, v_, level_); }
  void settle() const;

  const Eigen::VectorXd& z() const { return z_; }                    ///< n * state_lags, newest sample first
  const Eigen::MatrixXd& theta() const { return theta_; }            ///< r x J n: level j has the columns from j n on
  const Eigen::VectorXd& variance() const { return v_; }             ///< n, running variance v
  const Eigen::VectorXd& level() const { return level_; }            ///< J, probabilities of the levels
  const Eigen::VectorXd& innovation() const { return innovation_; }  ///< n, of the last update; NaN where missing
  /// r x r (lower triangle), covariance of an output's coefficients in a level, divided by v.
  const Eigen::MatrixXd& P(Eigen::Index level, Eigen::Index output) const {
    return P_[static_cast<std::size_t>(at(level, output))];
  }
  /// s + h'Ph of the first level, the variance of an output's prediction divided by v.
  double growth(Eigen::Index output) const { return growth_(output, 0); }
  /// P(output <= measured value + away) before the last update. `weight`: probabilities of the levels, J.
  double probability(Eigen::Index output, double away, const Vector& weight) const;
  /// Probabilities of the levels (J), given what came before the last update and its first `outputs` outputs. Returns
  /// the log density of these outputs.
  double weigh_levels(Eigen::Index outputs, Eigen::VectorXd& weight) const;

 private:
  DriftingModel model_;
  StudentNoise noise_;
  Eigen::VectorXd quantum_;                       ///< n; 0 for a continuous signal
  Eigen::VectorXd start_variance_, start_level_;  ///< n, J
  Eigen::MatrixXd theta_, mixed_theta_;
  std::vector<Eigen::MatrixXd> P_, mixed_P_;
  Eigen::VectorXd z_, v_, level_, predicted_level_;  ///< the levels after and before the last update
  MixingWeights mixing_;                             ///< of the levels
  Eigen::VectorXd h_, prediction_, variance_, innovation_, sample_, deviation_, weight_;
  Eigen::MatrixXd Ph_;                                  ///< r x J n
  Eigen::MatrixXd growth_, of_level_, error_, spread_;  ///< n x J: s + h'Ph, predictions, errors, standard deviations
  Eigen::VectorXd one_ = Eigen::VectorXd::Ones(1);

  Eigen::Index levels() const { return level_.size(); }
  Eigen::Index at(Eigen::Index level, Eigen::Index output) const { return level * model_.structure.states + output; }
  void mix();
  void mix_output(Eigen::Index level, Eigen::Index output);
  void predict_level(Eigen::Index level);
  void pass_time();
  double log_density(Eigen::Index output, Eigen::Index level) const;
  void learn();
  void adapt_variance();
};

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
/// Noise levels go on switching: each has its own covariance of the lagged e, and these are mixed
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
