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

/// T(i, j) = P(mode j next | mode i now). A type of its own: mixing weights, whose columns sum to one, are none.
class TransitionMatrix {
 public:
  TransitionMatrix() : matrix_(Eigen::MatrixXd::Identity(1, 1)) {}
  /// Throws std::invalid_argument unless the matrix is square and its rows are nonnegative with sum one within 1e-9.
  /// Normalises the rows; construction from matrix() keeps every bit.
  explicit TransitionMatrix(Eigen::MatrixXd row_stochastic);
  /// `stay` on the diagonal; the other entries of a row are equal. K = 1 gives 1.
  static TransitionMatrix sticky(Eigen::Index modes, double stay);

  const Eigen::MatrixXd& matrix() const { return matrix_; }
  Eigen::Index modes() const { return matrix_.rows(); }

 private:
  Eigen::MatrixXd matrix_;
};

/// filter::StateDependentTransition, a multinomial logit (McFadden 1974). z[k] = (x[k], v[k]) is known before the
/// measurement of sample k + 1. A constant added to a column of the weights has no effect.
struct TransitionLogit {
  Eigen::MatrixXd weights = {};    ///< K x d, d = n + acting inputs [1 / unit of z]; if empty, T holds for every z
  Eigen::VectorXd reference = {};  ///< d, the value of z for which T holds

  bool empty() const { return weights.size() == 0; }
};

/// Workspace for the transition probabilities of a step, sized once.
struct TransitionWorkspace {
  Eigen::MatrixXd T;               ///< K x K; each row sums to one
  Eigen::VectorXd factor, offset;  ///< K; offset = weights * reference

  TransitionWorkspace(Eigen::Index modes, const TransitionLogit& logit) {
    if (logit.empty()) return;
    T.resize(modes, modes);
    factor.resize(modes);
    offset = logit.weights * logit.reference;
  }
};

/// Upper limit of the difference of log odds, which keeps every row of T possible. Larger ones are practically certain.
inline constexpr double largest_log_odds = 200.0;

/// The probabilities at (x, v). The result is T if x or v is not finite. Does not allocate.
template <class X, class V>
const Eigen::MatrixXd& transition_at(const Eigen::MatrixXd& T, const TransitionLogit& logit, const X& x, const V& v,
                                     TransitionWorkspace& at) {
  if (logit.empty()) return T;
  at.factor = -at.offset;
  for (Eigen::Index a = 0; a < x.size(); ++a) at.factor += logit.weights.col(a) * x(a);
  for (Eigen::Index a = 0; a < v.size(); ++a) at.factor += logit.weights.col(x.size() + a) * v(a);
  if (!at.factor.allFinite()) return T;
  at.factor = (at.factor.array() - at.factor.maxCoeff()).max(-largest_log_odds).exp();
  for (Eigen::Index i = 0; i < T.rows(); ++i) {
    double sum = 0.0;
    for (Eigen::Index j = 0; j < T.cols(); ++j) sum += at.T(i, j) = T(i, j) * at.factor(j);
    at.T.row(i) /= sum;
  }
  return at.T;
}

/// filter::Mode, with what is known about its numbers.
struct Mode {
  LinearModel model;                     ///< A (n x n), B (n x m), c (n)
  Eigen::MatrixXd Q;                     ///< n x n process noise covariance per step
  Eigen::MatrixXd parameter_covariance;  ///< p x p, covariance of theta over the mode's windows
  Eigen::VectorXd standard_error;        ///< p, standard errors of theta
  double weight = 1.0;                   ///< share of the windows that belong to this mode

  /// Parameters of a motion model and their standard errors. The fields above then belong to its linearisation.
  Eigen::VectorXd motion_theta = {}, motion_standard_error = {};
  Eigen::MatrixXd Q_standard_error = {};  ///< n x n, standard errors of Q; only for refined banks, else empty

  /// Coefficients of the terms that are added to x[k+1], and their standard errors, measured states x T; may be empty.
  Eigen::MatrixXd bend = {}, bend_standard_error = {};
  EstimatedStepResponse response = {};  ///< response to steps of the inputs; empty but for single models
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
  double log_score = 0.0;    ///< [nats/sample]
  Eigen::Index samples = 0;  ///< number of scored training samples
};

/// filter::CoefficientDrift, of the competitor `drifting` (DriftingFilter).
struct BankDrift {
  DriftRates rates = {};
  Eigen::VectorXd scale = {};  ///< r, root mean square of each regressor, positive; empty without drift
  GridTuning tuning = {};      ///< how the competitor `drifting` was tuned

  bool empty() const { return scale.size() == 0; }
};

/// filter::RunningNoise. e is a prediction error with Student's t distribution of variance v (s + h'Ph). P is the
/// covariance of the coefficients divided by v, s the noise level. With the levels' probabilities mu after a sample,
///   v <- max(lam v + (1 - lam) sum_j mu_j e_j^2 / (s_j + h'P_j h), floor).
/// Given the past and the level, outputs are independent.
struct RunningNoise {
  double lam = 0.9;            ///< forgetting factor of the running variance, in [0, 1]
  double nu = 0.0;             ///< degrees of freedom, above 2; 0 for a normal distribution
  Eigen::VectorXd floor = {};  ///< n, smallest value of v; if empty, the noise is Q and constant

  /// Horizons in samples, ascending from 2, and for each horizon the factor on the first-order variance.
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
  std::vector<Mode> modes;                ///< K >= 1
  std::vector<Eigen::Index> motion = {};  ///< K, modes of one motion share theta; empty: each mode is one of its own
  /// While a bank is learned: above 1, every motion has so many modes in a row whose Q differ by factors, one per
  /// level, and T is the Kronecker product of a chain of motions and one of levels.
  Eigen::Index noise_levels = 1;
  Eigen::MatrixXd C;  ///< n_y x n
  Eigen::MatrixXd R;  ///< n_y x n_y
  /// n_y, spacing q of measured values [state unit]; 0 or empty: continuous. The filter's R is then at least q^2 / 12,
  /// and the score of a value is the mass of its interval.
  Eigen::VectorXd quantum = {};
  TransitionMatrix transition;          ///< K x K
  TransitionLogit transition_logit;     ///< dependence of the transitions on state and input; empty: constant
  Eigen::VectorXd initial_probability;  ///< K
  std::vector<std::string> state_names, input_names;
  double dt_s = 0.0;  ///< median sample period of the training data
  std::vector<ScreenedMode> screened;
  std::vector<ModelParameter> motion_parameters;  ///< parameters of a motion model; empty for linear models
  BankDrift drift;                                ///< drift of a single mode with running noise; empty: none
  MotionTerms terms = {};                         ///< nonlinear terms, the same for all modes
  RunningNoise running_noise = {};                ///< noise of a single mode that drifts; empty: the noise is Q
  Eigen::MatrixXd R_standard_error;               ///< n_y x n_y; empty unless R was estimated with the bank
  Eigen::MatrixXd transition_standard_error;      ///< K x K, standard errors of T; only for refined banks, else empty

  Eigen::Index mode_count() const { return static_cast<Eigen::Index>(modes.size()); }
  Eigen::Index motion_of(Eigen::Index mode) const { return motion.empty() ? mode : motion[mode]; }
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

/// Throws std::invalid_argument with the name of the first part whose size does not fit the other parts, or whose
/// numbers are none that a filter can use. Returns the bank.
const Bank& validate(const Bank& bank);
/// Checks the sizes only. Candidates of an optimiser may have extreme numbers.
void check_sizes(const Bank& bank);

/// Start of a filter from its first measurement: x[0] = gain y[0]; with lags, from those of all samples in z, each of
/// which has the covariance R.
struct StartMoments {
  Eigen::MatrixXd gain;        ///< n x n_y, the pseudo-inverse C+; n x n with lagged states
  Eigen::MatrixXd covariance;  ///< n x n, C+ R C+' plus a wide variance in directions that C does not measure
};

StartMoments start_moments(const Bank& bank);

}  // namespace modebank
