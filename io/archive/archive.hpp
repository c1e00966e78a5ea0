#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "filter/judge/combination.hpp"
#include "filter/judge/diagnostics.hpp"
#include "filter/judge/evaluate.hpp"
#include "filter/judge/finding.hpp"
#include "filter/judge/horizon.hpp"
#include "filter/judge/scores.hpp"
#include "filter/learn/chain/chain.hpp"
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

/// How an archive was made: program, libraries and inputs.
struct Provenance {
  std::string modebank_version;
  std::string created;  ///< time of creation in UTC, ISO 8601
  std::string command_line;
  std::string config_hash;
  std::string data_hash;
  std::vector<std::pair<std::string, std::string>> versions;  ///< version of each library or tool
  std::vector<InputFile> inputs;
};

/// Evaluations of one filter on all runs, in the order of the recording.
struct FilterEvaluation {
  std::string filter;  ///< the bank or a competitor
  std::vector<RunEvaluation> runs;
  std::vector<FreeRun> free_runs =
      {};                 ///< only with filter.simulate; the archive leaves out `pit`, `log_density` and `notes`
  bool streamed = false;  ///< true: the runs are in an unfinished file; memory holds only the arrays that later stages
                          ///< read

  using Fields = std::set<std::string>;  ///< names of arrays in the archive
  /// Reads these fields of a run. Its other arrays stay empty.
  using Reading = std::function<void(std::size_t run, const Fields& fields, RunEvaluation& said, FreeRun& free_run)>;
  Reading in_file = {};  ///< reads a run from the file, if the runs are still there (Evaluations::in_file)

  /// Calls `body` with the evaluation of one run. The evaluation is the one in memory, or `fields` read from the file.
  void with_run(std::size_t run, const Fields& fields, const std::function<void(const RunEvaluation&)>& body) const;
  void with_free_run(std::size_t run, const std::function<void(const FreeRun&)>& body) const;
};

/// Receives one run's evaluation and the run's index in the recording. Memory need not hold all evaluations.
using EvaluationSink =
    std::function<void(const std::string& filter, std::size_t run, const RunEvaluation& said, const FreeRun* free_run)>;

/// Residual tests of one model on all runs, in the order of the recording.
struct ResidualTestSet {
  std::string model;  ///< `global` (residuals one step ahead), or a filter: the bank or a competitor (scores z)
  std::vector<ResidualTests> runs;
};

/// Number of samples that have a given label and a given most probable mode of a filter.
struct ConfusionRow {
  std::string filter;
  Role role = Role::test;
  std::string label;
  Index mode = 0;
  Index samples = 0;
  double share = 0.0;  ///< this number as a share of all samples with the label
};

/// The recording of an execution, with its labels, its sampling and its lag.
struct DataPart {
  std::optional<Recording> recording;
  std::optional<RunLabels> labels;  ///< with data.label
  double step_scatter = 0.0;        ///< scatter of the recording's time steps, divided by their median
                                    ///< (io/import/sampling.hpp)
  std::optional<LagReport> lag;     ///< only with data.lag_s = auto
};

/// The results of one execution, stage by stage. A stage that did not run is absent. The Finding stores `terms_asked`.
struct Archive : DataPart, Learning {
  Provenance provenance;
  std::string config;                        ///< the resolved configuration, itself a valid configuration file
  std::vector<std::string> mode_names = {};  ///< names of the bank's modes; empty for a mode without a name
  std::vector<FilterEvaluation> evaluations;
  std::vector<SummaryRow> summary;
  std::vector<HorizonRow> horizons;              ///< with filter.horizon
  std::vector<CombinationRow> combination = {};  ///< weight of each filter in the combined forecasts
  std::vector<DiagnosticsRow> diagnostics;
  std::vector<ResidualTestSet> residual_tests;
  std::vector<FreeRunRow> free_runs = {};    ///< with filter.simulate
  std::vector<ConfusionRow> confusion = {};  ///< only with data.label and a scored bank
  std::optional<Finding> finding = {};       ///< only with a scored bank

  /// Whether modes of the bank are components of the mixture. False if the bank was refined or time steps scatter.
  bool mixture_makes_bank() const { return mixture && !unrefined && step_scatter == 0.0; }
};

/// Writes the archive under a temporary name in the same folder, flushes and closes it, hashes it and renames it. On
/// failure throws DataError and leaves no file behind. docs/reference/archive.md describes the layout. Every number is
/// stored exactly.
void write_archive(const std::filesystem::path& path, const Archive& archive);
/// Like the function above, but makes the archive on disk rather than in memory. write_archive does this for
/// evaluations above 128 MB and responsibilities above 256 MB. Memory then never holds all of them.
void write_large_archive(const std::filesystem::path& path, const Archive& archive);

/// Writes an archive that contains only data and windows. `produce` returns its `count` windows in parts
/// (stream_windows), so memory holds one part at a time. Returns the result of `produce`.
WindowFits write_archive(const std::filesystem::path& path, const Archive& archive, Index count,
                         const std::function<WindowFits(const WindowSink&)>& produce);

/// Writes an archive whose evaluations are written as soon as they are made. `make` passes evaluations to the sink,
/// from one thread, and returns the other parts of the archive. Rethrows the exceptions of `make`.
void write_archive(const std::filesystem::path& path, const Recording& recording,
                   const std::function<const Archive&(const EvaluationSink&)>& make);

/// Where the evaluations of an archive are. `in_file`: FilterEvaluation::with_run reads evaluations on demand, and
/// arrays of windows that no page shows stay empty.
enum class Evaluations { in_memory, in_file };

/// Reads all stages in the file; every value is exactly the written one. Throws DataError if shapes disagree or a
/// position lies outside its array. Values are checked only by verify_archive.
Archive read_archive(const OpenArchive& file, Evaluations evaluations = Evaluations::in_memory);

/// Result of a verification. If `problems` is empty, the archive is complete and valid.
struct Verification {
  std::vector<std::string> problems;
  bool ok() const { return problems.empty(); }
};

/// Checks hash, format, schema version and required members. Also checks every value: finite, positive definite or
/// summing to one, as its rule demands. Throws ConfigurationError if the file is missing.
Verification verify_archive(const std::filesystem::path& path);
/// Problems in the members and values of an open archive.
std::vector<std::string> problems_of(const OpenArchive& file);

}  // namespace modebank
