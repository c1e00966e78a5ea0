#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "ident/model/linear_model.hpp"
#include "ident/model/motion_model.hpp"
#include "ident/model/step_response.hpp"
#include "ident/model/terms.hpp"
#include "modebank/filter/bank.hpp"

namespace modebank {

/// Row-stochastic matrix of mode transitions, T(i, j) = P(mode j next | mode i now). It has its own type, because
/// mixing weights (whose columns sum to one) must not be passed instead. Checked once, at construction.
class TransitionMatrix {
 public:
  TransitionMatrix() : matrix_(Eigen::MatrixXd::Identity(1, 1)) {}
  /// Throws std::invalid_argument unless the matrix is square and its rows are nonnegative with sum one within 1e-9.
  /// Rows are then normalised if their sum differs from one by more than rounding. So construction from matrix() keeps
  /// every bit.
  explicit TransitionMatrix(Eigen::MatrixXd row_stochastic);
  /// `stay` on the diagonal; the other entries of a row are equal. K = 1 gives 1.
  static TransitionMatrix sticky(Eigen::Index modes, double stay);

  const Eigen::MatrixXd& matrix() const { return matrix_; }
  Eigen::Index modes() const { return matrix_.rows(); }

 private:
  Eigen::MatrixXd matrix_;
};

/// State-dependent transition probabilities, a multinomial logit (McFadden 1974; StateDependentTransition in
/// modebank/filter/bank.hpp). z[k] = (x[k], v[k]) is known before the measurement of sample k + 1. A constant added to
/// a column of the weights has no effect.
struct TransitionLogit {
  Eigen::MatrixXd weights = {};    ///< K x d, d = n + acting inputs [1 / unit of z]; if empty, T holds for every z
  Eigen::VectorXd reference = {};  ///< d, the value of z for which T holds

  bool empty() const { return weights.size() == 0; }
};

/// Workspace for the transition probabilities of a step, sized once.
struct TransitionWorkspace {
  TransitionWorkspace(Eigen::Index modes, const TransitionLogit& logit)
      : offset(logit.empty() ? Eigen::VectorXd() : Eigen::VectorXd(logit.weights * logit.reference)) {
    if (logit.empty()) return;
    T.resize(modes, modes);
    factor.resize(modes);
  }

  Eigen::MatrixXd T;       ///< K x K; each row sums to one
  Eigen::VectorXd factor;  ///< K
  Eigen::VectorXd offset;  ///< K, the product of weights and reference
};

/// Upper limit of the difference of log odds. Larger differences are practically certain. The limit keeps every row of
/// T possible.
inline constexpr double largest_log_odds = 200.0;

/// The probabilities at (x, v). The result is T if x or v is not finite. Does not allocate.
template <class X, class V>
const Eigen::MatrixXd& transition_at(const Eigen::MatrixXd& T, const TransitionLogit& logit, const X& x, const V& v,
                                     TransitionWorkspace& at) {
  if (logit.empty()) return T;
  const Eigen::Index K = T.rows(), n = x.size();
  at.factor = -at.offset;
  for (Eigen::Index a = 0; a < n; ++a) at.factor += logit.weights.col(a) * x(a);
  for (Eigen::Index a = 0; a < v.size(); ++a) at.factor += logit.weights.col(n + a) * v(a);
  if (!at.factor.allFinite()) return T;
  at.factor = (at.factor.array() - at.factor.maxCoeff()).max(-largest_log_odds).exp();
  for (Eigen::Index i = 0; i < K; ++i) {
    double sum = 0.0;
    for (Eigen::Index j = 0; j < K; ++j) sum += at.T(i, j) = T(i, j) * at.factor(j);
    for (Eigen::Index j = 0; j < K; ++j) at.T(i, j) /= sum;
  }
  return at.T;
}

/// One factor on the process noise of every mode (NoiseByState in modebank/filter/bank.hpp). With its limits, 0.2 to 5,
/// a forecast remains usable if inputs differ from those of the training runs. Without limits, a factor learned on DART
/// lost 54 nats per sample on other runs.
struct NoiseFactor {
  Eigen::MatrixXd directions;  ///< d x (n + m): directions on which the noise depends. Each is scaled so that
                               ///< directions_i [z; v] has a root mean square of 1 on the training runs
  Eigen::VectorXd weights;     ///< d
  double offset = 0.0;         ///< with this offset, log f has mean zero on the training runs

  static constexpr double softening = 0.1, largest = 5.0;

  bool empty() const { return weights.size() == 0; }

  /// log f. NaN if an entry of z or v is not finite. Does not allocate.
  template <class Z, class V>
  double log_at(const Z& z, const V& v) const {
    double sum = -offset;
    for (Eigen::Index i = 0; i < weights.size(); ++i) {
      double along = 0.0;
      for (Eigen::Index j = 0; j < z.size(); ++j) along += directions(i, j) * z(j);
      for (Eigen::Index j = 0; j < v.size(); ++j) along += directions(i, z.size() + j) * v(j);
      sum += weights(i) * std::log(std::abs(along) + softening);
    }
    return std::clamp(sum, -std::log(largest), std::log(largest));
  }
  template <class Z, class V>
  double at(const Z& z, const V& v) const {
    return std::exp(log_at(z, v));
  }
};

/// One mode of motion in state space: x[k+1] = x + A x + B u + c + w, w ~ N(0, Q). With lags, z and v of
/// LinearStructure replace x and u.
struct Mode {
  LinearModel model;                     ///< A (n x n), B (n x m), c (n)
  Eigen::MatrixXd Q;                     ///< n x n process noise covariance per step
  Eigen::MatrixXd parameter_covariance;  ///< p x p, covariance of theta over the mode's windows
  Eigen::VectorXd standard_error;        ///< p, standard errors of theta
  double weight = 1.0;                   ///< share of the windows that belong to this mode

  /// Parameters of a motion model and their standard errors. The fields above then belong to its linearisation.
  Eigen::VectorXd motion_theta = {};
  Eigen::VectorXd motion_standard_error = {};
  Eigen::MatrixXd Q_standard_error = {};  ///< n x n, standard errors of Q; only for refined banks, else empty

  /// Coefficients of the terms, measured states x T; empty without terms. Terms multiplied by these coefficients are
  /// added to x[k+1].
  Eigen::MatrixXd bend = {};
  Eigen::MatrixXd bend_standard_error = {};  ///< their standard errors, in the same order; empty without terms
  EstimatedStepResponse response = {};       ///< response to steps of the inputs; empty but for single models
};

/// Drift of the coefficients of scaled regressors, in units of the noise variance v (method: section 6).
struct DriftRates {
  double q = 0.0;     ///< variance added to every coefficient per step; 0 for constant coefficients
  double p0 = 0.0;    ///< variance of every coefficient at the start; if q and p0 are 0, coefficients are fixed
  double leak = 1.0;  ///< factor per step on the difference from theta0, in (0, 1]

  bool operator==(const DriftRates&) const = default;
};

/// Log score of the settings that were chosen on a grid, on the training runs.
struct GridTuning {
  double log_score = 0.0;    ///< log score of the training runs [nats/sample]
  Eigen::Index samples = 0;  ///< number of scored training samples
};

/// Drift of the coefficients of the competitor `drifting` within a run (DriftingFilter).
struct BankDrift {
  DriftRates rates = {};
  Eigen::VectorXd scale = {};            ///< r, root mean square of each regressor, positive; empty without drift
  Wandering wandering = Wandering::all;  ///< which coefficients drift
  GridTuning tuning = {};                ///< how the competitor `drifting` was tuned

  bool empty() const { return scale.size() == 0; }
};

/// Noise of one motion. The variance follows each output separately (method: section 6, `drifting`). e is a prediction
/// error with Student's t distribution of variance v (s + h'Ph). P is the covariance of the coefficients divided by v.
/// s is the noise level: 1, or one of J levels between which the noise switches by a Markov chain. At a start, v is the
/// diagonal of Q. Then, with the probabilities mu of the levels after the sample,
///   v <- max(lam v + (1 - lam) sum_j mu_j e_j^2 / (s_j + h'P_j h), floor).
/// Given the past and the level, outputs are independent.
struct RunningNoise {
  double lam = 0.9;            ///< forgetting factor of the running variance, in [0, 1]
  double nu = 0.0;             ///< degrees of freedom, above 2; 0 for a normal distribution
  Eigen::VectorXd floor = {};  ///< n, smallest value of v; if empty, the noise is Q and constant

  /// Horizons in samples, ascending from 2, and for each horizon the factor on the first-order variance. One sample
  /// ahead the factor is 1, because the prediction is that of the filter.
  std::vector<std::pair<Eigen::Index, double>> horizon_factor = {};

  Eigen::MatrixXd level = {};      ///< n x J, variance of each level in units of v; if empty, one level of 1
  Eigen::MatrixXd switching = {};  ///< J x J, row i: probabilities of the next level after level i

  bool empty() const { return floor.size() == 0; }
  Eigen::Index levels() const { return std::max<Eigen::Index>(level.cols(), 1); }
  /// The factor of the longest horizon that is not above this one; 1 if every horizon is above it.
  double factor_at(Eigen::Index horizon) const {
    double factor = 1.0;
    for (const auto& [ahead, value] : horizon_factor)
      if (ahead <= horizon) factor = value;
    return factor;
  }
};

/// K modes, their transitions, and the measurement y = C x + v, v ~ N(0, R).
struct Bank {
  std::string model = "linear";  ///< `linear`, `varx`, or the name of a motion model
  LinearStructure structure;
  std::vector<Mode> modes;  ///< K >= 1
  Eigen::MatrixXd C;        ///< n_y x n
  Eigen::MatrixXd R;        ///< n_y x n_y

  /// n_y, spacing q of measured values [state unit]. The filter's R is then at least q^2 / 12, and the score of a value
  /// is the mass of its interval. 0 marks a continuous signal; an empty vector means that all are continuous.
  Eigen::VectorXd quantum = {};
  TransitionMatrix transition;          ///< K x K
  TransitionLogit transition_logit;     ///< dependence of the transition matrix on state and input; empty if it is
                                        ///< constant
  Eigen::VectorXd initial_probability;  ///< K
  std::vector<std::string> state_names;
  std::vector<std::string> input_names;
  double dt_s = 0.0;  ///< median sample period of the training data
  std::vector<ScreenedMode> screened;
  std::vector<ModelParameter> motion_parameters;  ///< parameters of a motion model; empty for linear models
  BankDrift drift;                                ///< drift of a single mode with running noise; empty without drift
  MotionTerms terms = {};                         ///< nonlinear terms, the same for all modes; empty without terms
  NoiseFactor noise_factor = {};                  ///< factor on every Q that depends on state and input; empty without
                                                  ///< a factor
  RunningNoise running_noise = {};   ///< running noise of a single mode that drifts (the competitor `drifting`); if
                                     ///< empty, the noise is Q
  Eigen::MatrixXd R_standard_error;  ///< n_y x n_y, standard errors of R; empty unless R was estimated with the bank
  Eigen::MatrixXd transition_standard_error;  ///< K x K, standard errors of T; only for refined banks, else empty
  Eigen::MatrixXd transition_weight_error;    ///< K x d standard errors of the logit's weights; empty if unknown

  Eigen::Index mode_count() const { return static_cast<Eigen::Index>(modes.size()); }
  bool is_quantised() const { return (quantum.array() > 0.0).any(); }
  /// n_y, variance of the rounding error, q^2 / 12: it is uniform within the quantum. 0 for continuous signals.
  Eigen::VectorXd rounding_variance() const;
  /// Covariance of the difference between recorded values and C x: R, with at least the variance of rounding.
  Eigen::MatrixXd recording_noise() const;
  /// The variances of the first mode's process noise, n_s.
  auto noise_variance() { return modes.front().Q.diagonal().head(structure.states); }
  Eigen::VectorXd noise_variance() const { return modes.front().Q.diagonal().head(structure.states); }
  Eigen::VectorXd theta(Eigen::Index mode) const { return pack(structure, modes[mode].model); }
};

/// A bank of one mode with exactly measured states: C selects the newest sample, R = 0, Q = diag(variance) of the
/// measured states.
Bank one_mode_bank(const LinearStructure& structure, const Eigen::VectorXd& theta, const Eigen::VectorXd& variance);

/// Whether the bank has several modes with the same theta. Such modes differ only in noise.
bool has_one_theta(const Bank& bank);

/// Throws std::invalid_argument with the name of the first invalid part. A part is invalid if its size does not fit the
/// other parts, a number is not finite, a variance is negative, or probabilities are invalid.
void validate(const Bank& bank);
/// Checks the sizes only. Candidates of an optimiser may have extreme numbers.
void check_sizes(const Bank& bank);

/// Start of a filter from its first measurement: x[0] = gain y[0]. With lags, the first measurements of all samples in
/// z are used; the gain is I, and each sample has the covariance R.
struct StartMoments {
  Eigen::MatrixXd gain;        ///< n x n_y, the pseudo-inverse C+; n x n with lagged states
  Eigen::MatrixXd covariance;  ///< n x n, C+ R C+' plus a wide variance in directions that C does not measure. For C =
                               ///< I it is R
};

StartMoments start_moments(const Bank& bank);

}  // namespace modebank
