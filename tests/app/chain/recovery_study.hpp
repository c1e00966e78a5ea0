#pragma once

#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/simulate/simulate.hpp"
#include "mixture/select.hpp"

namespace modebank::test {

inline constexpr Index window_length = 25;

/// A kind of simulated recording, and a way to choose K on it. Windows have window_length transitions and the features
/// parameters+noise.
struct RecoveryCase {
  std::string name;
  Index hold_samples = 1;      ///< number of samples between two draws of the inputs
  double dwell_windows = 0.0;  ///< mean stay in a mode, in window lengths; 0: each run stays in one mode
  Index step = 1;
  Criterion criterion = Criterion::bic;
  bool noise_component = false;
  bool error_aware = false;
};

/// Like configs/simulate_linear.ini, with 2 to 6 modes (by seed), 40 runs of 500 samples and R = Q / 25.
SimulationOptions recovery_system(const RecoveryCase& recovery, int seed);

struct Simulated {
  Recording recording;
  std::vector<SimulatedRun> runs;
};
Simulated simulate_recording(const SimulationOptions& options, int seed);

/// Choices of the criteria for one seed, from 1 to true K + 3.
struct RecoveredSize {
  Index truth = 0;
  Index chosen = 0;        ///< by the case's criterion
  Index naive = 0;         ///< by BIC as if windows were independent
  double clustered = 0.0;  ///< share of clustered windows
};
RecoveredSize recover_size(const RecoveryCase& recovery, int seed);

/// All seeds 1 to `seeds`, in parallel.
std::vector<RecoveredSize> recover_sizes(const RecoveryCase& recovery, int seeds);

/// Number of seeds on which the difference to the true K is 0.
int right(const std::vector<RecoveredSize>& sizes, Index RecoveredSize::*choice);

}  // namespace modebank::test
