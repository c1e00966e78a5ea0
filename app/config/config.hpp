#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "app/config/chain_options.hpp"
#include "ident/simulate/simulate.hpp"
#include "modebank/base/names.hpp"

namespace modebank::app {

/// The filter of an archive that `track` runs.
enum class TrackedFilter { bank, baseline, noise_only, one_motion, drifting, combined, nonlinear };

struct TrackConfig {
  TrackedFilter filter = TrackedFilter::bank;
  bool json = false;  ///< set by --json: output lines are JSON objects, whatever the form of the input
};

/// The [report] section, which limits the size of a page.
struct ReportConfig {
  double size_mb = 64.0;  ///< largest size of a page [1e6 bytes]
};

struct ArchiveConfig {
  std::string output;  ///< empty: the name of the configuration file with the extension .h5, in the current folder
  std::string bank;    ///< archive whose bank is judged; empty: a bank is learned
};

struct JobConfig {
  int threads = 0;  ///< 0: one thread per core
  std::uint64_t seed = 1;

  std::size_t thread_count() const {
    return threads > 0 ? static_cast<std::size_t>(threads) : std::max(1u, std::thread::hardware_concurrency());
  }
};

struct SimulateConfig {
  std::string name = "two_grounds";       ///< name of a built-in system, or a system file; it sets the members below
  SimulationOptions system;               ///< its runs and samples are keys of [simulate]
  std::vector<std::string> ground_names;  ///< names of the modes
  std::string output = "simulated";
  double rate_hz = 10.0, state_rate_hz = 100.0;
};

/// How the number of lags, the delay or the length of windows is set.
enum class LagChoice { by_model, automatic, number };

/// Whether the number is searched for. `by_model`: the answer if the configuration does not state the key, so that the
/// model decides.
inline bool is_automatic(LagChoice choice, bool by_model) {
  return choice == LagChoice::automatic || (choice == LagChoice::by_model && by_model);
}

/// Which numbers of the model's structure are searched for, and how the length of windows is set.
struct StructureConfig {
  bool automatic_model = true;  ///< window.model = auto: the choice by_model then means automatic
  LagChoice state = LagChoice::by_model, input = LagChoice::by_model, delay = LagChoice::by_model;
  LagChoice length = LagChoice::by_model, step = LagChoice::by_model;  ///< how the length and the step of windows are
                                                                       ///< set
  bool automatic_intercept = true;                                     ///< window.intercept = auto
};

/// The steps of `modebank study`. `all` does every step.
enum class StudyStage { all, plan, run, merge, status, submit };

/// The [study] section. app/study/space/study_space.hpp parses `vary` and `together`.
struct StudyConfig {
  std::vector<std::string> vary;      ///< "KEY = v1 | v2" for each varied key
  std::vector<std::string> together;  ///< "KEY, KEY": keys whose values change together
  std::int64_t sample = 0;            ///< number of sampled points; 0: the full grid
  std::int64_t repeats = 1;
  std::string output;  ///< folder of the study; empty: the configuration file's name with .study, in the current folder
  int jobs = 0;        ///< number of processes; 0: one per core
  StudyStage stage = StudyStage::all;
  std::string slurm_options;  ///< options for sbatch, separated by spaces
};

/// Options of every stage from one configuration file. The option table lists their keys.
struct Config {
  DataOptions data;
  FitOptions window;
  ClusterOptions mixture;
  StructureConfig structure;
  std::string terms = "auto";
  BankOptions bank;
  std::vector<std::string> mode_names;
  FilterOptions filter;
  ScoringOptions scoring;  ///< keys of [filter] that do not affect a filter's steps
  TrackConfig track;
  ReportConfig report;
  ArchiveConfig archive;
  JobConfig job;
  SimulateConfig simulate;
  StudyConfig study;
};

/// The options that determine the numbers of a run.
ChainOptions chain_options(const Config& config);

/// The options of the data section. They include the gap between blocks of data.split, which depends on the length and
/// lags of a window.
DataOptions data_options_of(const Config& config);

/// The options of the window section for a fit before the search for lags.
FitOptions window_options_of(const Config& config);
/// Which lags of the configuration are searched for.
SearchedLags searched_lags_of(const Config& config);
/// Which numbers of the windows are computed from the structure and the data.
AutomaticWindows automatic_windows_of(const Config& config);

/// Checks values against each other before any data file is opened. Throws ConfigurationError with the names of the
/// keys.
void validate(const Config& config);

}  // namespace modebank::app

template <>
struct modebank::EnumNames<modebank::app::TrackedFilter> {
  static constexpr Names<7> values{"bank", "baseline", "noise_only", "one_motion", "drifting", "combined", "nonlinear"};
};

template <>
struct modebank::EnumNames<modebank::app::StudyStage> {
  static constexpr Names<6> values{"all", "plan", "run", "merge", "status", "submit"};
};
