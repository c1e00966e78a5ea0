#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// How inputs evolve. `white`: new values at every sample. `hold`: new values every `hold_samples`. `drive`: commands
/// like those of a skid-steer robot's driver, with random steps and ramps, standstill and equal wheels. The length of a
/// command is geometric with mean `hold_samples`. Levels are uniform in [-input_amplitude, input_amplitude].
enum class InputLaw { white, hold, drive };

template <>
struct EnumNames<InputLaw> {
  static constexpr Names<3> values{"white", "hold", "drive"};
};

/// Options for drawing the inputs.
struct CommandOptions {
  InputLaw input_law = InputLaw::drive;
  Index hold_samples = 10;           ///< number of samples in a command (law `drive`: mean number)
  double input_amplitude = 0.5;      ///< commands are drawn from [-amplitude, amplitude] [input unit]
  double input_quantum = 0.0;        ///< applied inputs are rounded to multiples of this; 0 means no rounding
  double standstill_fraction = 0.1;  ///< share of commands with all inputs zero (law `drive`)
  double equal_fraction = 0.3;       ///< share of commands with all inputs equal (law `drive`)
  Index samples = 300;               ///< per run
  Index inputs = 2;
};

/// A switching linear system x[k+1] = x + A_s x + B_s u (+ c_s) + w, w ~ N(0, Q_s), y = x + v, v ~ N(0, R), s a Markov
/// chain.
struct SimulationOptions : CommandOptions {
  std::vector<Eigen::VectorXd> modes;  ///< theta of each mode, p entries per mode
  std::vector<double> process_sd;  ///< standard deviation of the process noise w [state unit]; one value per mode, or
                                   ///< one value for all modes
  double measurement_sd = 0.0;     ///< standard deviation of the measurement noise v [state unit]
  Eigen::MatrixXd transition;      ///< K x K, row = from; if empty, it follows from dwell_samples, with equal
                                   ///< probabilities off the diagonal
  double dwell_samples = 0.0;     ///< mean number of samples in a mode, at least 1; with 0, run i stays in mode (i / 2)
                                  ///< mod K. Even runs (training) and odd runs (held out) then both contain every mode
  double outlier_fraction = 0.0;  ///< share of measured samples with an outlier
  double outlier_sd = 0.0;        ///< standard deviation of an outlier [state unit]
  Index runs = 12;
  double dt_s = 1.0 / 6.5;  ///< sample period
  bool intercept = false;
  Index states = 1;
};

/// One simulated run: measurements and truth.
struct SimulatedRun {
  Trajectory measured;   ///< `state` is the measurement y, and `truth` is x
  Eigen::VectorXi mode;  ///< N, the mode that drives transition k -> k+1
};

/// Simulates runs "00", "01", ... Even runs are training runs, odd runs are held-out runs. A run starts at state zero,
/// in a mode drawn from the chain's stationary distribution. The quantised inputs drive the true system. Outliers are
/// added to the measured sample. Run i depends on options, seed and i alone. Throws ConfigurationError if sizes
/// disagree, a value is out of range, the rows of the matrix do not sum to one, or an unstable mode makes the state
/// overflow.
std::vector<SimulatedRun> simulate(const SimulationOptions& options, std::uint64_t seed);

}  // namespace modebank
