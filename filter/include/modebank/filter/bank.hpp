#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "modebank/base/matrix.hpp"
#include "modebank/filter/wandering.hpp"

namespace modebank {
struct Bank;
}

namespace modebank::filter {

/// One mode of motion, x[k+1] = x[k] + A x[k] + B u[k] + c + w[k], w ~ N(0, Q), per sample period. With lags, x and u
/// are the stacked samples z = [x[k]; x[k-1]; ...] and v = [u[k+1-delay]; ...].
struct Mode {
  Matrix A;                     ///< n x n, of the increment: the full form is I + A
  Matrix B;                     ///< n x m
  std::vector<double> c;        ///< n
  Matrix Q;                     ///< n x n, covariance of the process noise per step [state unit^2]
  Matrix parameter_covariance;  ///< p x p, spread of theta over the mode's windows; empty: zero
  double weight = 1.0;          ///< share of the windows
};

/// How state and input change the switches: P(j | i, z) is proportional to transition_ij exp(w_j' (z - reference)), z
/// the state and the acting inputs as a step starts. Empty: the transition matrix holds whatever z is.
struct StateDependentTransition {
  Matrix weights;                 ///< K x d, row j is w_j; d = n + acting inputs
  std::vector<double> reference;  ///< d, the z at which the transition matrix holds
};

/// How state and input scale the process noise: a step from z has Q times exp(sum_i weights_i log(|directions_i z| +
/// 0.1) - offset), bounded to between a fifth and five, z the state and the acting inputs. Empty: Q itself.
struct NoiseByState {
  Matrix directions;            ///< d x (n + acting inputs)
  std::vector<double> weights;  ///< d
  double offset = 0.0;          ///< of the exponent
};

/// How every mode's theta wanders in a run, regressor by regressor of [z; v; (1)]. Empty: it stays.
struct CoefficientDrift {
  std::vector<double> scale;  ///< per regressor its size, in whose units the coefficient wanders
  double rate = 0.0;          ///< variance that a step adds to each coefficient, in units of Q, >= 0
  double start = 0.0;         ///< variance of each coefficient at a start, in units of Q, >= 0
  double leak = 1.0;          ///< what a step leaves of a coefficient's difference from the mode's, in (0, 1]
  Wandering wandering = Wandering::all;  ///< other than all only with RunningNoise
};

/// Noise of one mode that drifts, whose variance v follows each measured state by itself, from the diagonal of Q on:
/// v <- max(forgetting v + (1 - forgetting) e^2, floor), e the error of a prediction over what the coefficients'
/// uncertainty makes of it. Empty: Q itself. It is the noise of the competitor `drifting`.
struct RunningNoise {
  std::vector<double> floor;         ///< n_y, least v [state unit^2]
  double forgetting = 0.9;           ///< in [0, 1]
  double degrees_of_freedom = 0.0;   ///< of Student's t, above 2; 0: Gaussian
  std::vector<double> horizon = {};  ///< ascending, from 2 samples ahead on
  std::vector<double> factor = {};   ///< of the variance of forecasts so far ahead, up to the next horizon
};

/// How fast the noise scale of FilterNoise::adaptive follows a run.
struct NoiseMemory {
  double forgetting = 0.98;    ///< per sample, in (0, 1]
  double prior_samples = 5.0;  ///< samples at scale one that a run's start is worth, > 0
};

/// All numbers of a bank, to write one down or to read it: K modes, how they follow each other, and how the state is
/// measured, y = C x + v, v ~ N(0, R).
struct BankDescription {
  std::vector<Mode> modes;      ///< K >= 1
  Matrix C;                     ///< n_y x n; empty: the state is measured
  Matrix R;                     ///< n_y x n_y, covariance of the measurement noise [state unit^2]
  std::vector<double> quantum;  ///< n_y, of what measured values are multiples [state unit], 0: continuous; empty: all
  Matrix transition;            ///< K x K, row i: probabilities of the mode that follows mode i
  StateDependentTransition state_dependent_transition;  ///< empty: constant
  std::vector<double> initial_probability;              ///< K; empty: all alike
  std::vector<std::string> state_names;                 ///< of the measured states; may be empty
  std::vector<std::string> input_names;                 ///< of the inputs; may be empty
  double dt_s = 0.0;               ///< sample period that one step stands for [s]; 0: whatever comes
  std::ptrdiff_t inputs = 0;       ///< input channels
  std::ptrdiff_t state_lags = 1;   ///< samples of the state that predict the next one
  std::ptrdiff_t input_lags = 1;   ///< samples of the input that act on one transition
  std::ptrdiff_t input_delay = 1;  ///< samples from an input to its first effect
  bool intercept = false;          ///< whether c is part of theta
  NoiseMemory noise_memory;        ///< for filters whose noise is adaptive
  NoiseByState noise_by_state;     ///< empty: constant
  CoefficientDrift drift;          ///< empty: none
  RunningNoise running_noise;      ///< empty: the noise is Q
};

/// A bank of modes, immutable and cheap to copy; its numbers live inside the library.
class Bank {
 public:
  /// Throws std::invalid_argument naming the first size or number that no filter can work with.
  explicit Bank(const BankDescription& description);
  /// For the library's own use.
  explicit Bank(std::shared_ptr<const modebank::Bank> bank);

  /// A copy of its numbers.
  BankDescription description() const;
  /// K.
  std::ptrdiff_t modes() const;
  /// n, with lags the stacked samples.
  std::ptrdiff_t states() const;
  /// n_y, what a step takes as its measurement.
  std::ptrdiff_t measurements() const;
  /// Input channels, what a step takes as its input.
  std::ptrdiff_t inputs() const;
  /// Sample period that one step stands for [s].
  double dt_s() const;

  /// For the library's own use.
  const modebank::Bank& internal() const { return *bank_; }

 private:
  std::shared_ptr<const modebank::Bank> bank_;
};

}  // namespace modebank::filter
