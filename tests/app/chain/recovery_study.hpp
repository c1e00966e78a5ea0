#pragma once

#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/simulate/simulate.hpp"
#include "mixture/select.hpp"

namespace modebank::test {

inline constexpr Index window_length = 25;

/// A kind of simulated recording, and a way to choose K. Windows have window_length transitions, and the features are
/// parameters+noise.
struct RecoveryCase {
  std::string name;
  Index hold_samples = 1;      ///< number of samples for which each input is held
  double dwell_windows = 0.0;  ///< mean stay in a mode, in units of the window length; 0 if each run stays in one mode
  Index step = 1;
  bool noise_component = false;
  bool error_aware = false;
};

/// A system as in configs/simulate_linear.ini, with 40 runs of 500 samples and R = Q / 25. It has 2 to 6 modes,
/// depending on the seed.
SimulationOptions recovery_system(const RecoveryCase& recovery, int seed);

struct Simulated {
  Recording recording;
  std::vector<SimulatedRun> runs;
};
Simulated simulate_recording(const SimulationOptions& options, int seed);

/// Choices of K by different criteria for one seed. Candidates are 1 to the true K + 3.
struct RecoveredSize {
  Index truth = 0;
  Index chosen = 0;        ///< choice by BIC
  Index naive = 0;         ///< choice by BIC for independent windows
  double clustered = 0.0;  ///< share of the windows that are clustered
};
RecoveredSize recover_size(const RecoveryCase& recovery, int seed);

/// Results of the seeds 1 to `seeds`. The seeds run in parallel.
std::vector<RecoveredSize> recover_sizes(const RecoveryCase& recovery, int seeds);

/// Number of seeds for which the choice equals the true K.
int right(const std::vector<RecoveredSize>& sizes, Index RecoveredSize::*choice);

}  // namespace modebank::test
