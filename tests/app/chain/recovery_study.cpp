#include "tests/app/chain/recovery_study.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "ident/fit/fit_windows.hpp"
#include "mixture/criteria.hpp"

namespace modebank::test {

SimulationOptions recovery_system(const RecoveryCase& recovery, int seed) {
  static const std::vector<Eigen::Vector3d> modes{{-0.60, -0.72, 0.72}, {-0.25, -0.20, 0.20}, {-0.45, -0.10, 0.50},
                                                  {-0.80, -0.50, 0.15}, {-0.10, -0.50, 0.80}, {-0.90, -0.10, -0.30}};
  SimulationOptions options;
  const int count = 2 + seed % 5;
  for (int k = 0; k < count; ++k) options.modes.emplace_back(modes[k]);
  options.process_sd = {0.02};
  options.measurement_sd = 0.004;
  options.input_law = recovery.hold_samples > 1 ? InputLaw::hold : InputLaw::white;
  options.hold_samples = recovery.hold_samples;
  options.dwell_samples = recovery.dwell_windows * static_cast<double>(window_length);
  options.runs = 40;
  options.samples = 500;
  return options;
}

Simulated simulate_recording(const SimulationOptions& options, int seed) {
  Simulated result;
  result.runs = simulate(options, static_cast<std::uint64_t>(seed));
  result.recording.states = {{"wz", "rad/s"}};
  result.recording.inputs = {{"left", "m/s"}, {"right", "m/s"}};
  for (std::size_t i = 0; i < result.runs.size(); ++i) {
    result.recording.runs.push_back(result.runs[i].measured);
    result.recording.runs.back().role = i % 2 == 0 ? Role::train : Role::test;
  }
  return result;
}

RecoveredSize recover_size(const RecoveryCase& recovery, int seed) {
  const SimulationOptions system = recovery_system(recovery, seed);
  const Recording recording = simulate_recording(system, seed).recording;
  FitOptions fit;
  fit.length = window_length;
  fit.step = recovery.step;
  const WindowFits fits = fit_windows(recording, fit);
  SelectionOptions options;
  options.components.resize(system.modes.size() + 3);
  std::iota(options.components.begin(), options.components.end(), Index{1});
  options.em.restarts = 2;
  options.em.noise_component = recovery.noise_component;
  const FeatureCloud cloud =
      make_features(fits, FeatureSet::parameters_and_noise, WindowChoice::automatic, recording.states,
                    WindowsOverSwitch::leave_out, recovery.error_aware ? WindowErrors::include : WindowErrors::ignore);
  const MixtureResult result = select_mixture(fits, cloud, options, static_cast<std::uint64_t>(seed));
  const auto naive = std::ranges::min_element(result.candidates, {}, &Candidate::bic_naive);
  return {static_cast<Index>(system.modes.size()), result.mixture.components(), naive->components,
          static_cast<double>((result.labels.array() >= 0).count()) / static_cast<double>(fits.count())};
}

std::vector<RecoveredSize> recover_sizes(const RecoveryCase& recovery, int seeds) {
  std::vector<RecoveredSize> sizes(static_cast<std::size_t>(seeds));
  tbb::parallel_for(0, seeds, [&](int i) { sizes[i] = recover_size(recovery, i + 1); });
  return sizes;
}

int right(const std::vector<RecoveredSize>& sizes, Index RecoveredSize::*choice) {
  return static_cast<int>(
      std::count_if(sizes.begin(), sizes.end(), [&](const RecoveredSize& size) { return size.*choice == size.truth; }));
}

}  // namespace modebank::test
