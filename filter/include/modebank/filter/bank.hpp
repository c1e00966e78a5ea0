#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "modebank/base/matrix.hpp"
#include "modebank/ident/input_delays.hpp"

namespace modebank {

struct Bank;

/// A mode that was removed from a bank, with the reason.
struct ScreenedMode {
  std::ptrdiff_t component = 0;  ///< index of its component in the mixture
  double weight = 0.0;           ///< share of the windows that belong to the mode
  double spectral_radius = 0.0;  ///< spectral radius of I + A
  std::string reason;            ///< "starved", "unstable" or "duplicate of mode 1"
};

}  // namespace modebank

namespace modebank::filter {

/// One mode of motion: x[k+1] = x[k] + A x[k] + B u[k] + c + w[k] with w ~ N(0, Q), per sample period. With lags, x and
/// u are the stacked samples z = [x[k]; x[k-1]; ...] and v = [u[k+1-delay]; ...].
struct Mode {
  Matrix A;                     ///< n x n, increment form; the full form is I + A
  Matrix B;                     ///< n x m; empty: zero
  std::vector<double> c;        ///< n; empty: zero
  Matrix Q;                     ///< n x n, covariance of the process noise per step [state unit^2]
  Matrix parameter_covariance;  ///< p x p, covariance of theta over the mode's windows; empty: zero
  double weight = 1.0;          ///< share of the windows that belong to this mode
};

/// State-dependent transition probabilities: P(j | i, z) is proportional to transition_ij exp(w_j' (z - reference)). z
/// holds the state and the acting inputs at the start of a step. If empty, the transition matrix holds for every z.
struct StateDependentTransition {
  Matrix weights;                 ///< K x d, row j is w_j; d = n + acting inputs
  std::vector<double> reference;  ///< d, the value of z for which the transition matrix holds
};

/// Drift of theta within a run, per regressor of [z; v; (1)], of a single mode with RunningNoise (the competitor
/// `drifting`). If empty, theta is constant.
struct CoefficientDrift {
  std::vector<double> scale;  ///< size of each regressor; the drift of its coefficient is in units of 1 / size
  double rate = 0.0;          ///< variance that each step adds to a coefficient, in units of Q, >= 0
  double start = 0.0;         ///< variance of a coefficient at the start of a run, in units of Q, >= 0
  double leak = 1.0;          ///< factor per step on a coefficient's difference from the mode's coefficient, in (0, 1]
};

/// Running noise variance of a single mode that drifts (the competitor `drifting`). The variance v of each measured
/// state starts at the diagonal of Q and follows v <- max(forgetting v + (1 - forgetting) e^2, floor). e is the
/// prediction error, divided by a factor for the uncertainty of the coefficients. If empty, Q is constant.
struct RunningNoise {
  std::vector<double> floor;         ///< n_y, smallest value of v [state unit^2]
  double forgetting = 0.9;           ///< forgetting factor, in [0, 1]
  double degrees_of_freedom = 0.0;   ///< degrees of freedom of Student's t, above 2; 0 for a normal distribution
  std::vector<double> horizon = {};  ///< horizons in samples, ascending, at least 2
  std::vector<double> factor = {};   ///< factor on the variance of forecasts from each horizon up to the next one
  Matrix level;       ///< n_y x J, variances of J noise levels in units of v, which switch by a Markov chain; empty: 1
  Matrix transition;  ///< J x J, row i: probabilities of the next level after level i
};

/// All numbers of a bank: K modes, their transitions, and the measurement y = C x + v with v ~ N(0, R).
struct BankDescription {
  std::vector<Mode> modes;      ///< K >= 1
  Matrix C;                     ///< n_y x n; empty: the identity
  Matrix R;                     ///< n_y x n_y, covariance of the measurement noise [state unit^2]
  std::vector<double> quantum;  ///< n_y, spacing of measured values [state unit]; 0 or empty: continuous
  Matrix transition;            ///< K x K, row i: probabilities of the next mode after mode i
  StateDependentTransition state_dependent_transition;  ///< empty: constant
  std::vector<double> initial_probability;              ///< K; empty: all modes are equally probable
  std::vector<std::string> state_names;                 ///< names of the measured states; may be empty
  std::vector<std::string> input_names;                 ///< names of the inputs; may be empty
  double dt_s = 0.0;                                    ///< sample period of one step [s]; 0 if it is not fixed
  std::ptrdiff_t inputs = 0;                            ///< number of input channels
  std::ptrdiff_t state_lags = 1;  ///< number of state samples from which the next one is predicted
  std::ptrdiff_t input_lags = 1;  ///< number of input samples that act on one transition
  InputDelays input_delay = 1;    ///< number of samples from each input to its first effect
  bool intercept = false;         ///< whether c is part of theta
  std::vector<double> centre;     ///< measured states, then inputs: the point about which theta is taken; empty: zero
  CoefficientDrift drift;         ///< empty: none
  RunningNoise running_noise;     ///< empty: the noise is Q
};

/// A bank of modes; immutable and cheap to copy.
class Bank {
 public:
  /// Throws std::invalid_argument if a filter cannot use a size or number; the message names the first one.
  explicit Bank(const BankDescription& description);
  /// For internal use by the library.
  explicit Bank(std::shared_ptr<const modebank::Bank> bank);

  /// A copy of the bank's numbers.
  BankDescription description() const;
  /// Number of modes K.
  std::ptrdiff_t modes() const;
  /// Size n of the state. With lags, n is the size of the stacked samples.
  std::ptrdiff_t states() const;
  /// Number of measured signals n_y.
  std::ptrdiff_t measurements() const;
  /// Number of input channels.
  std::ptrdiff_t inputs() const;
  /// Sample period of one step [s].
  double dt_s() const;

  /// For internal use by the library.
  const modebank::Bank& internal() const { return *bank_; }

 private:
  std::shared_ptr<const modebank::Bank> bank_;
};

}  // namespace modebank::filter
