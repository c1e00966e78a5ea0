#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "app/study/run/trial_runner.hpp"
#include "app/study/run/trial_store.hpp"
#include "app/study/space/study_plan.hpp"

namespace modebank::app {

/// State of a trial in a worker's report. begun: it has the claim and computes. broken: the machine's fault, not the
/// trial's (a full disk, data that changed): the study must stop.
enum class TrialOutcome { begun, present, computed, failed, broken };

struct TrialReport {
  std::size_t row = 0;  ///< of the plan
  TrialOutcome outcome = TrialOutcome::begun;
  std::string message = {};  ///< why it failed, or what was wrong with the archive that was there
  double seconds = 0.0;
  std::array<double, stage_count> stage_seconds = {};
  /// The bank's log score on the held-out runs, without these on the training runs; NaN: none.
  double log_score = std::numeric_limits<double>::quiet_NaN();
};

/// The log score that progress is told by.
double headline_score(const std::vector<std::pair<std::string, double>>& scores);

/// The work of a process, as its parent gives it.
struct WorkerTask {
  Config config;      ///< the study's
  std::string typed;  ///< the command line, for provenance
  std::string version;
  std::vector<std::string> varied_keys;
  std::vector<TrialRow> rows;       ///< those left to do, in order
  std::vector<std::size_t> places;  ///< of these rows in the plan
  std::size_t threads = 1;
};
std::string pack_task(const WorkerTask& task);
WorkerTask unpack_task(const std::string& bytes);

/// One line of a worker's output.
std::string pack_report(const TrialReport& report);
TrialReport unpack_report(const std::string& line);

/// Tells the program that it is to be a worker: modebank WORD PARENT FIRST, with a packed task on standard input. The
/// worker takes the rows from FIRST on and then those before, claims each, and leaves archives or records of failure.
/// It reports on standard output, and ends with its parent, however that ends.
inline constexpr const char* worker_word = "--study-worker";
int run_study_worker(int argc, char** argv);

}  // namespace modebank::app
