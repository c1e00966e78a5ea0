#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "app/config/chain_options.hpp"
#include "app/config/study_config.hpp"
#include "ident/simulate/simulate.hpp"
#include "ident/simulate/simulate_vehicle.hpp"

namespace modebank::app {

/// Which filter of an archive `track` runs.
enum class TrackedFilter { bank, baseline, noise_only, one_motion, drifting, combined, nonlinear };

struct TrackConfig {
  TrackedFilter filter = TrackedFilter::bank;
  std::string checkpoint;
  Index checkpoint_interval = 0;
  std::string resume;
  bool forecast = false;
  double watchdog_s = 0.0;  ///< period of lines that say how it fares; 0: none
  bool json = false;        ///< lines out are objects whatever comes in: --json
};

/// The [report] section: what a page may hold.
struct ReportConfig {
  double size_mb = 64.0;  ///< largest page [1e6 bytes]
  Index runs = 10;        ///< of a study, with pages of their own
};

struct ArchiveConfig {
  std::string output;  ///< empty: the configuration file's name with .h5, in the current folder
  std::string input;   ///< archive that supplies earlier stages
  std::string bank;    ///< archive whose bank is evaluated
};

struct JobConfig {
  int threads = 0;  ///< 0: all cores
  std::uint64_t seed = 1;

  std::size_t thread_count() const {
    return threads > 0 ? static_cast<std::size_t>(threads) : std::max(1u, std::thread::hardware_concurrency());
  }
};

enum class SimulatedSystem { linear, vehicle };

struct SimulateConfig {
  std::string name = "husky_ice";  ///< of a system or of its file, which decides on all down to ground_names
  SimulatedSystem kind = SimulatedSystem::linear;
  SimulationOptions system;               ///< the linear system; commands, runs and outliers also of the vehicle
  VehicleSimulationOptions vehicle;       ///< what only a vehicle has
  std::vector<std::string> ground_names;  ///< of a vehicle's kinds of ground
  std::string output = "simulated";
  double rate_hz = 6.5;
  double state_rate_hz = 65.0;
};

/// How a number of lags, the delay or the windows' length came into a configuration.
enum class LagChoice { by_model, automatic, number };

/// Whether the number is found: `by_model` where nothing is said of it.
inline bool is_automatic(LagChoice choice, bool by_model) {
  return choice == LagChoice::automatic || (choice == LagChoice::by_model && by_model);
}

/// The numbers of the model's structure that are searched for, and the length that follows from it.
struct StructureConfig {
  bool automatic_model = true;  ///< window.model = auto: by_model means automatic
  LagChoice state = LagChoice::by_model, input = LagChoice::by_model, delay = LagChoice::by_model;
  LagChoice length = LagChoice::by_model, step = LagChoice::by_model;  ///< of windows
};

/// Every stage's options, as one configuration file states them. The option table lists their keys.
struct Config {
  DataOptions data;
  FitOptions window;
  ClusterOptions mixture;
  StructureConfig structure;
  std::string terms = "auto";
  NoiseByInput noise_by_input = NoiseByInput::automatic;
  BankOptions bank;
  std::vector<std::string> mode_names;
  FilterOptions filter;
  ScoringOptions scoring;  ///< of the [filter] section what is not about how a filter steps
  TrackConfig track;
  ReportConfig report;
  ArchiveConfig archive;
  JobConfig job;
  SimulateConfig simulate;
  StudyConfig study;
};

/// What of it decides the numbers of a run.
ChainOptions chain_options(const Config& config);

/// The data section with what it takes from others: how much of a window lies between the blocks of data.split.
DataOptions data_options_of(const Config& config);

/// The window section as a model is fitted, before anything is found.
FitOptions window_options_of(const Config& config);
/// Which of its lags are found.
SearchedLags searched_lags_of(const Config& config);
/// Which numbers of windows follow from the structure and the data.
AutomaticWindows automatic_windows_of(const Config& config);

/// Checks values against each other, before any file of data is opened. Throws ConfigurationError naming the keys.
void validate(const Config& config);

}  // namespace modebank::app

template <>
struct modebank::EnumNames<modebank::app::TrackedFilter> {
  static constexpr Names<7> values{"bank", "baseline", "noise_only", "one_motion", "drifting", "combined", "nonlinear"};
};

template <>
struct modebank::EnumNames<modebank::app::SimulatedSystem> {
  static constexpr Names<2> values{"linear", "vehicle"};
};
