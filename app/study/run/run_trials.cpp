#include "app/study/run/run_trials.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <map>
#include <memory>
#include <random>
#include <thread>

#include "app/study/run/claim.hpp"
#include "app/study/run/worker_process.hpp"
#include "io/archive/study_file.hpp"
#include "io/files/csv_field.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point time) { return std::chrono::duration<double>(Clock::now() - time).count(); }

/// Appends one line per trial and execution: time, host, process, key, outcome, total seconds, seconds of each stage
/// (0: reused), message. If two machines append at the same time, a line may be lost; only the log is then incomplete.
void log_trial(const TrialStore& store, pid_t process, const TrialRow& row, const TrialReport& report) {
  static constexpr std::array<const char*, 5> words{"begun", "present", "done", "failed", "stopped"};
  char host[256] = "";
  ::gethostname(host, sizeof host - 1);
  const std::string line =
      fmt::format("{:%Y-%m-%dT%H:%M:%SZ},{},{},{},{},{:.6g},{:.6g},{}\n", fmt::gmtime(std::time(nullptr)),
                  csv_field(host), process, row.key, words[static_cast<std::size_t>(report.outcome)], report.seconds,
                  fmt::join(report.stage_seconds, ","), csv_field(report.message));
  try {
    append_to_file(store.log(), line);
  } catch (const std::exception& error) {
    spdlog::debug("{}: {}", store.log().string(), error.what());
  }
}

std::size_t job_count(const StudyConfig& study) {
  return study.jobs > 0 ? static_cast<std::size_t>(study.jobs) : std::max(1U, std::thread::hardware_concurrency());
}

/// Number of threads of one trial if several trials run at the same time.
std::size_t threads_per_trial(const Config& study) {
  if (study.job.threads > 0) return study.job.thread_count();
  return std::max<std::size_t>(1, study.job.thread_count() / job_count(study.study));
}

/// The report on a trial that an earlier execution has completed; empty if the trial must be run. Removes a damaged
/// archive. Also removes a record of failure, so that the trial is tried again.
std::optional<TrialReport> left_before(const TrialStore& store, const TrialStore::Listing& there, const TrialRow& row,
                                       std::size_t place) {
  if (there.archives.count(row.key) > 0) {
    const std::vector<std::string> problems = store.problems(row.key);
    // If a process was killed just after it wrote the archive, its claim still exists. Taking the claim removes it.
    if (problems.empty() && there.claims.count(row.key) > 0) static_cast<void>(Claim::take(store.claim(row.key)));
    if (problems.empty()) return TrialReport{.row = place, .outcome = TrialOutcome::present};
    spdlog::warn("{}: {}; computed again", store.archive(row.key).string(), problems.front());
    const std::optional<Claim> mine = Claim::take(store.claim(row.key));
    if (mine) std::filesystem::remove(store.archive(row.key));
  }
  if (there.failures.count(row.key) > 0) store.forget_failure(row.key);
  return std::nullopt;
}

/// Runs a study to its end.
class StudyRun {
 public:
  StudyRun(const TrialSettings& settings, const StudyPlan& plan, const TrialGroups& groups,
           const TrialListener& listener)
      : settings_(settings), store_(settings.config.study.output), rows_(plan.table.rows), listener_(listener) {
    sort_out(plan, groups);
  }

  RunResult run() {
    const Clock::time_point start = Clock::now();
    const TaskFile file(pack_task(task_));
    const std::size_t count = std::min(job_count(settings_.config.study), task_.rows.size());
    // The start is random, because processes on other machines run the same groups.
    const std::size_t any = std::random_device()();
    for (std::size_t i = 0; i < count && !stopping_; ++i)
      start_worker(file, (any + i * starts_.size() / count) % starts_.size());
    while (!workers_.empty() && !stopping_) {
      wait();
      for (Worker& worker : workers_)
        if (!stopping_) handle_message(file, worker);
      std::erase_if(workers_, [](const Worker& worker) { return !worker.process; });
    }
    for (const Worker& worker : workers_) stop(worker);
    workers_.clear();
    for (const auto& [place, report] : finished_) sort_in(place, report);
    result_.seconds = seconds_since(start);
    return std::move(result_);
  }

 private:
  struct Worker {
    std::unique_ptr<WorkerProcess> process = nullptr;
    std::size_t group = 0;                  ///< index of the group with which the worker began
    std::optional<std::size_t> trial = {};  ///< index of the row that the worker runs now
    std::optional<std::size_t> last = {};   ///< index of the row that the worker began last
    Clock::time_point since = {};           ///< start time of the worker's trial
  };

  /// Assigns unfinished rows to workers. All other rows are counted as finished.
  void sort_out(const StudyPlan& plan, const TrialGroups& groups) {
    const TrialStore::Listing there = store_.list();
    std::vector<std::size_t> places;
    for (const auto& group : groups) places.insert(places.end(), group.begin(), group.end());
    std::vector<std::optional<TrialReport>> before(rows_.size());
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
      before[places[i]] = left_before(store_, there, rows_[places[i]], places[i]);
    });
    all_ = places.size();
    task_ = {.config = settings_.config,
             .typed = settings_.typed,
             .version = settings_.version,
             .varied_keys = plan.table.varied_keys,
             .rows = {},
             .places = {},
             .threads = threads_per_trial(settings_.config)};
    for (const auto& group : groups) {
      const std::size_t first = task_.rows.size();
      for (const std::size_t place : group)
        if (before[place]) {
          if (before[place]->outcome == TrialOutcome::present) result_.whole.push_back(rows_[place].key);
          finish(0, *before[place]);
        } else {
          task_.rows.push_back(rows_[place]);
          task_.places.push_back(place);
        }
      if (task_.rows.size() > first) starts_.push_back(first);
    }
  }

  void start_worker(const TaskFile& file, std::size_t group) {
    workers_.push_back({.process = std::make_unique<WorkerProcess>(file, starts_[group]), .group = group});
  }

  /// Waits until a worker reports or ends.
  void wait() const {
    constexpr int patience_ms = 1000;
    std::vector<pollfd> channels;
    for (const Worker& worker : workers_) channels.push_back({worker.process->channel(), POLLIN, 0});
    ::poll(channels.data(), channels.size(), patience_ms);
  }

  void handle_message(const TaskFile& file, Worker& worker) {
    const auto lines = worker.process->read_lines();
    if (!lines) return replace(file, worker);
    for (const std::string& line : *lines) take(worker, unpack_report(line));
  }

  void take(Worker& worker, const TrialReport& report) {
    vain_ = 0;
    if (report.outcome == TrialOutcome::begun) {
      worker.trial = worker.last = report.row;
      worker.since = Clock::now();
      return;
    }
    worker.trial.reset();
    if (report.outcome == TrialOutcome::broken) {
      result_.broken = report.message;
      stopping_ = true;
    } else {
      finish(worker.process->process(), report);
    }
  }

  /// Starts a new worker in place of a worker that has ended. If the old worker crashed, its trial has failed.
  void replace(const TaskFile& file, Worker& worker) {
    const std::string why = worker.process->end();
    if (worker.trial) {
      const std::string& key = rows_[*worker.trial].key;
      TrialReport crash{.row = *worker.trial,
                        .outcome = TrialOutcome::failed,
                        .message = why,
                        .seconds = seconds_since(worker.since)};
      if (store_.has_archive(key))
        crash = {.row = crash.row, .outcome = TrialOutcome::present};  // the archive exists; only the report of the
                                                                       // worker is missing
      else
        store_.record_failure(key, crash.message);
      finish(worker.process->process(), crash);
    }
    stop(worker);
    constexpr int most_in_vain = 10;
    if (!why.empty() && ++vain_ > most_in_vain) {
      result_.broken = "worker processes end before their first run: " + why;
      stopping_ = true;
    }
    worker = {.process = nullptr, .group = worker.group};
    if (!why.empty() && !stopping_) worker.process = std::make_unique<WorkerProcess>(file, starts_[worker.group]);
  }

  /// The worker's claim is removed before the worker is reaped.
  void stop(const Worker& worker) const {
    worker.process->kill();
    static_cast<void>(worker.process->end());
    if (worker.last) Claim::end_of(worker.process->process(), store_.claim(rows_[*worker.last].key));
  }

  /// Several workers may report that the same trial exists. Only the report of the worker that ran the trial counts.
  void finish(pid_t process, const TrialReport& report) {
    const auto [place, fresh] = finished_.try_emplace(report.row, report);
    if (!fresh && report.outcome != TrialOutcome::computed) return;
    place->second = report;
    const TrialRow& row = rows_[report.row];
    if (process != 0 && report.outcome != TrialOutcome::present) log_trial(store_, process, row, report);
    listener_(row, report, finished_.size(), all_);
  }

  void sort_in(std::size_t place, const TrialReport& report) {
    if (report.outcome == TrialOutcome::present) ++result_.present;
    if (report.outcome == TrialOutcome::failed) result_.failed.push_back(place);
    if (report.outcome != TrialOutcome::computed) return;
    ++result_.computed;
    result_.whole.push_back(rows_[place].key);
  }

  const TrialSettings& settings_;
  const TrialStore store_;
  const std::vector<TrialRow>& rows_;
  const TrialListener& listener_;
  WorkerTask task_;
  std::vector<std::size_t> starts_;  ///< first row of each group that has unfinished rows
  std::vector<Worker> workers_;
  std::map<std::size_t, TrialReport> finished_;  ///< reports by row index
  std::size_t all_ = 0;
  int vain_ = 0;  ///< number of consecutive workers that ended without a report
  bool stopping_ = false;
  RunResult result_;
};

}  // namespace

RunResult run_trials(const TrialSettings& settings, const StudyPlan& plan, const TrialGroups& groups,
                     const TrialListener& listener) {
  return StudyRun(settings, plan, groups, listener).run();
}

}  // namespace modebank::app
