#pragma once

#include <array>
#include <string>
#include <vector>

#include "app/study/run/trial_runner.hpp"
#include "app/study/run/trial_store.hpp"
#include "app/study/space/study_plan.hpp"

namespace modebank::app {

/// State of a trial in a worker's report. begun: the worker has the claim and computes. broken: the fault is in the
/// machine and not in the trial (a full disk, changed data), so the study must stop.
enum class TrialOutcome { begun, present, computed, failed, broken };

struct TrialReport {
  std::size_t row = 0;  ///< index of the row in the plan
  TrialOutcome outcome = TrialOutcome::begun;
  std::string message = {};  ///< reason for a failure, or fault of an existing archive
  double seconds = 0.0;
  std::array<double, stage_count> stage_seconds = {};
};

/// The work that the parent process gives to a worker.
struct WorkerTask {
  Config config;      ///< the study's
  std::string typed;  ///< the command line, for the provenance
  std::string version;
  std::vector<std::string> varied_keys;
  std::vector<TrialRow> rows;       ///< unfinished rows in their order
  std::vector<std::size_t> places;  ///< for each of these rows, its index in the plan
  std::size_t threads = 1;
};
std::string pack_task(const WorkerTask& task);
WorkerTask unpack_task(const std::string& bytes);

/// A report as one line of a worker's output.
std::string pack_report(const TrialReport& report);
TrialReport unpack_report(const std::string& line);

/// The word that starts the program as a worker: modebank WORD PARENT FIRST, with a packed task on standard input. The
/// worker claims the rows from FIRST on, then the rows before FIRST. For each row it writes an archive or a record of
/// failure. It reports on standard output, and ends when its parent ends.
inline constexpr const char* worker_word = "--study-worker";
int run_study_worker(int argc, char** argv);

}  // namespace modebank::app
