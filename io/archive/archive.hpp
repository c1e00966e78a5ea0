#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "filter/judge/decide/diagnostics.hpp"
#include "filter/judge/decide/finding.hpp"
#include "filter/judge/run/evaluate.hpp"
#include "filter/judge/run/free_run.hpp"
#include "filter/judge/run/horizon.hpp"
#include "filter/judge/score/combination.hpp"
#include "filter/judge/score/scores.hpp"
#include "filter/learn/chain/parts.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/run_labels.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/lag/report.hpp"
#include "ident/lag/structure.hpp"
#include "ident/model/local_model.hpp"
#include "ident/model/residual_tests.hpp"
#include "io/archive/bank/open_archive.hpp"
#include "io/files/input_file.hpp"
#include "mixture/select.hpp"

namespace modebank {

/// Origin of an archive: program, libraries, inputs.
struct Provenance {
  std::string modebank_version;
  std::string created;  ///< UTC, ISO 8601
  std::string command_line;
  std::string config_hash;
  std::string data_hash;
  std::vector<std::pair<std::string, std::string>> versions;  ///< library or tool -> version
  std::vector<InputFile> inputs;
};

/// One filter over all runs of the recording, in its order.
struct FilterEvaluation {
  std::string filter;  ///< bank or a competitor
  std::vector<RunEvaluation> runs;
  std::vector<FreeRun> free_runs =
      {};                 ///< only with filter.simulate; archives contain neither pit nor log_density nor notes
  bool streamed = false;  ///< true: the runs are in an unfinished file, and memory has only what later stages read

  using Fields = std::set<std::string>;  ///< names of arrays in the archive
  /// Reads these fields of a run; its other arrays stay empty.
  using Reading = std::function<void(std::size_t run, const Fields& fields, RunEvaluation& said, FreeRun& free_run)>;
  Reading in_file = {};  ///< reader of runs that are still in their file (Evaluations::in_file)

  /// Calls `body` with the evaluation of one run: the one in memory, or these fields from the file.
  void with_run(std::size_t run, const Fields& fields, const std::function<void(const RunEvaluation&)>& body) const;
  void with_free_run(std::size_t run, const std::function<void(const FreeRun&)>& body) const;
};

/// Receives one run's evaluation and its index in the recording, so that not all evaluations need to be in memory.
using EvaluationSink =
    std::function<void(const std::string& filter, std::size_t run, const RunEvaluation& said, const FreeRun* free_run)>;

/// Residual tests of one model over all runs of the recording, in its order.
struct ResidualTestSet {
  std::string model;  ///< `global` (residuals one step ahead), or a filter: bank or a competitor (scores z)
  std::vector<ResidualTests> runs;
};

/// Number of samples with one label for which one mode of a filter is the most probable.
struct ConfusionRow {
  std::string filter;
  Role role = Role::test;
  std::string label;
  Index mode = 0;
  Index samples = 0;
  double share = 0.0;  ///< share of the label's samples
};

/// The data of an execution.
struct DataPart {
  std::optional<Recording> recording;
  std::optional<RunLabels> labels;  ///< with data.label
  double step_scatter = 0.0;        ///< scatter of the recording's steps over their median (io/import/sampling.hpp)
  std::optional<LagReport> lag;     ///< only with data.lag_s = auto
};

/// The results of one execution, stage by stage. A stage that did not run is absent. (terms_asked is stored in the
/// Finding.)
struct Archive : DataPart, Learning {
  Provenance provenance;
  std::string config;                        ///< the resolved configuration, itself a valid configuration file
  std::vector<std::string> mode_names = {};  ///< names of the bank's modes; an empty name: the mode has none
  std::vector<FilterEvaluation> evaluations;
  std::vector<SummaryRow> summary;
  std::vector<HorizonRow> horizons;              ///< with filter.horizon
  std::vector<CombinationRow> combination = {};  ///< weight of each filter in the combined forecasts
  std::vector<DiagnosticsRow> diagnostics;
  std::vector<ResidualTestSet> residual_tests;
  std::vector<FreeRunRow> free_runs = {};    ///< with filter.simulate
  std::vector<ConfusionRow> confusion = {};  ///< only with data.label and a scored bank
  std::optional<Finding> finding = {};       ///< only with a scored bank

  /// Whether modes of the bank are components of the mixture: the bank was not refined, and time steps do not scatter.
  bool mixture_makes_bank() const { return mixture && !unrefined && step_scatter == 0.0; }
  bool one_motion_drifts() const { return one_motion && !one_motion->drift.empty(); }
};

/// Writes the archive under a temporary name in the same folder, flushes, closes, hashes and renames it. Throws
/// DataError on failure and leaves nothing behind. docs/reference/archive.md describes the layout. Every number is
/// stored as computed.
void write_archive(const std::filesystem::path& path, const Archive& archive);
/// The same, but the archive is made on disk rather than in memory. write_archive also does this for evaluations above
/// 128 MB and responsibilities above 256 MB, so these are never in memory as a whole.
void write_large_archive(const std::filesystem::path& path, const Archive& archive);

/// The same for an archive of only data and windows. `produce` returns its `count` windows in parts (stream_windows),
/// so that memory holds only one part at a time. Returns the result of `produce`.
WindowFits write_archive(const std::filesystem::path& path, const Archive& archive, Index count,
                         const std::function<WindowFits(const WindowSink&)>& produce);

/// The same for an archive whose evaluations are written as they are made. `make` passes them to the sink, from one
/// thread, and returns the rest of the archive. Throws the exceptions of `make`.
void write_archive(const std::filesystem::path& path, const Recording& recording,
                   const std::function<const Archive&(const EvaluationSink&)>& make);

/// Location of an archive's evaluations. `in_file`: evaluations are read on demand (FilterEvaluation::with_run), and
/// arrays of windows that no page shows stay empty.
enum class Evaluations { in_memory, in_file };

/// Reads all stages in the file, bit by bit as written. Throws DataError if shapes disagree or a position lies outside
/// its array. Only verify_archive checks values.
Archive read_archive(const OpenArchive& file, Evaluations evaluations = Evaluations::in_memory);

/// Result of a verification; no `problems` means that the archive is complete and valid.
struct Verification {
  std::vector<std::string> problems;
  bool ok() const { return problems.empty(); }
};

/// Checks hash, format, schema version, the layout's required members, and every value: finite, definite, summing to
/// one. Throws ConfigurationError if the file is missing.
Verification verify_archive(const std::filesystem::path& path);
/// Problems in the members and values of an open archive.
std::vector<std::string> problems_of(const OpenArchive& file);

}  // namespace modebank
