#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "modebank/base/matrix.hpp"

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

/// All numbers of a bank, to write one down or to read it: K modes, how they follow each other, and how the state is
/// measured, y = C x + v, v ~ N(0, R).
struct BankDescription {
  std::vector<Mode> modes;  ///< K >= 1
  Matrix C;                 ///< n_y x n; empty: the state is measured
  Matrix R;                 ///< n_y x n_y, covariance of the measurement noise [state unit^2]
  std::vector<double>
      quantum;        ///< n_y, of what measured values are multiples [state unit], 0: continuous; may be empty
  Matrix transition;  ///< K x K, row i: probabilities of the mode that follows mode i
  /// Where state and input move the switches: K x d, d = n + acting inputs. P(j | i, z) is proportional to T_ij
  /// exp(w_j' (z - reference)), z = (x, v) as a step starts; empty: T whatever z is.
  Matrix transition_weights;
  std::vector<double> transition_reference;  ///< d, the z at which T holds
  std::vector<double> initial_probability;   ///< K; empty: all alike
  std::vector<std::string> state_names;      ///< of the measured states; may be empty
  std::vector<std::string> input_names;      ///< of the inputs; may be empty
  double dt_s = 0.0;                         ///< sample period that one step stands for [s]; 0: whatever comes
  std::ptrdiff_t inputs = 0;                 ///< input channels
  std::ptrdiff_t state_lags = 1;             ///< samples of the state that predict the next one
  std::ptrdiff_t input_lags = 1;             ///< samples of the input that act on one transition
  std::ptrdiff_t input_delay = 1;            ///< samples from an input to its first effect
  bool intercept = false;                    ///< whether c is part of theta
  double noise_forgetting = 0.98;            ///< of the adaptive noise scale, per sample, in (0, 1]
  double noise_prior_samples = 5.0;          ///< samples at scale one that a run's start is worth, > 0
  /// Where state and input scale every Q: d x (n + acting inputs). A step from z under v has Q times exp(sum_i
  /// weights_i log(|directions_i [z; v]| + 0.1) - offset), bounded to between a fifth and five; empty: Q itself.
  Matrix noise_directions;
  std::vector<double> noise_weights;  ///< d
  double noise_offset = 0.0;          ///< of the exponent
  /// Of modes whose theta follows the run: a size per regressor [z; v; (1)], in whose units it wanders; empty: it
  /// stays.
  std::vector<double> drift_scale;
  double drift_rate = 0.0;   ///< variance that a step adds to each coefficient, in units of Q, >= 0
  double drift_start = 0.0;  ///< variance of each coefficient at a start, in units of Q, >= 0
  double drift_leak = 1.0;   ///< what a step leaves of a coefficient's difference from the mode's, in (0, 1]
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
