#include "app/study/run/study_worker.hpp"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/config/config_file.hpp"
#include "app/study/run/claim.hpp"
#include "io/archive/study_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

constexpr double most_cached_mb = 1000.0;  // largest size of the stored stages that runs share

using nlohmann::json;

void write_line(const std::string& line) {
  for (std::size_t sent = 0; sent < line.size();) {
    const ssize_t bytes = ::write(STDOUT_FILENO, line.data() + sent, line.size() - sent);
    if (bytes < 0 && errno != EINTR) ::_exit(1);  // the parent process has ended
    if (bytes > 0) sent += static_cast<std::size_t>(bytes);
  }
}

void report(const TrialReport& report) { write_line(pack_report(report) + "\n"); }

class Worker {
 public:
  explicit Worker(const WorkerTask& task)
      : task_(task), store_(task.config.study.output), runner_(store_.cache(), most_cached_mb) {}

  /// Works until every row has an archive or has failed, in this or another process.
  void run(std::size_t first) {
    std::vector<std::size_t> left(task_.rows.size());
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = (first + i) % left.size();
    for (bool again = false; !left.empty(); again = true) {
      std::vector<std::size_t> held;
      const TrialStore::Listing there = store_.list();
      for (const std::size_t row : left)
        if (!settle(row, there) && !take(row, again)) held.push_back(row);
      // Other processes hold the claims of all remaining rows.
      if (held.size() == left.size()) std::this_thread::sleep_for(std::chrono::milliseconds(again ? 500 : 50));
      left = std::move(held);
    }
  }

 private:
  TrialReport about(std::size_t row, TrialOutcome outcome, std::string message = {}) const {
    return {.row = task_.places[row], .outcome = outcome, .message = std::move(message)};
  }

  /// Reports a trial that another process has finished. Returns false if no process has.
  bool settle(std::size_t row, const TrialStore::Listing& there) const {
    const std::string& key = task_.rows[row].key;
    if (there.archives.count(key) > 0)
      report(about(row, TrialOutcome::present));
    else if (there.failures.count(key) > 0)
      report(about(row, TrialOutcome::failed, store_.failure(key).value_or("")));
    else
      return false;
    return true;
  }

  /// Claims the trial. Returns false if another process holds the claim.
  bool take(std::size_t row, bool again) {
    const std::string& key = task_.rows[row].key;
    const std::optional<Claim> mine = Claim::take(store_.claim(key));
    if (!mine) return false;
    // Checks the folder after taking the claim: before that, another process could still have finished the trial.
    if (again) store_.look_again();
    if (store_.has_archive(key)) return report(about(row, TrialOutcome::present)), true;
    if (const auto failure = store_.failure(key)) return report(about(row, TrialOutcome::failed, *failure)), true;
    report(about(row, TrialOutcome::begun));
    const auto start = std::chrono::steady_clock::now();
    TrialReport made = compute(row);
    made.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    made.stage_seconds = runner_.seconds();
    report(made);
    return true;
  }

  TrialReport compute(std::size_t row) {
    const TrialRow& trial = task_.rows[row];
    const Config config = trial_config(task_.config, task_.varied_keys, trial);
    const Archive* archive = nullptr;
    TrialReport made = about(row, TrialOutcome::computed);
    try {
      archive = &runner_.run(config, task_.typed);
    } catch (const std::exception& error) {
      made = about(row, TrialOutcome::failed, error.what());
    }
    try {
      if (archive)
        write(trial, config, *archive);
      else
        store_.record_failure(trial.key, made.message);
    } catch (const std::exception& error) {
      made = about(row, TrialOutcome::broken, error.what());
    }
    return made;
  }

  void write(const TrialRow& trial, const Config& config, const Archive& archive) const {
    if (trial_key(config, archive.provenance.data_hash, task_.version) != trial.key)
      throw DataError("the data have changed since the plan was made; start the study again to see which file");
    // Another process may have written the archive first. That archive is kept, because other processes may be reading
    // it.
    if (!store_.has_archive(trial.key)) write_archive(store_.archive(trial.key), archive);
    store_.forget_failure(trial.key);
  }

  const WorkerTask& task_;
  TrialStore store_;
  TrialRunner runner_;
};

/// Reads standard input from the beginning of the file, because all workers share this file.
std::string read_input() {
  std::string bytes(1 << 20, '\0');
  std::size_t size = 0;
  for (;;) {
    if (size == bytes.size()) bytes.resize(2 * size);
    const ssize_t more = ::pread(STDIN_FILENO, bytes.data() + size, bytes.size() - size, static_cast<off_t>(size));
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) break;
    size += static_cast<std::size_t>(more);
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace

std::string pack_task(const WorkerTask& task) {
  json rows = json::array();
  for (std::size_t i = 0; i < task.rows.size(); ++i)
    rows.push_back({task.places[i], task.rows[i].key, task.rows[i].varied, task.rows[i].repeat, task.rows[i].seed});
  std::string bytes;
  json::to_cbor(json{{"config", resolved_text(task.config)},
                     {"typed", task.typed},
                     {"version", task.version},
                     {"varied", task.varied_keys},
                     {"rows", rows},
                     {"threads", task.threads}},
                bytes);  // bytes of a file name need not be UTF-8
  return bytes;
}

WorkerTask unpack_task(const std::string& bytes) {
  const json packed = json::from_cbor(bytes);
  WorkerTask task{.config = resolved_config(packed.at("config")),
                  .typed = packed.at("typed"),
                  .version = packed.at("version"),
                  .varied_keys = packed.at("varied"),
                  .rows = {},
                  .places = {},
                  .threads = packed.at("threads")};
  for (const json& row : packed.at("rows")) {
    task.places.push_back(row.at(0));
    TrialRow& trial = task.rows.emplace_back();
    row.at(1).get_to(trial.key);
    row.at(2).get_to(trial.varied);
    row.at(3).get_to(trial.repeat);
    row.at(4).get_to(trial.seed);
  }
  return task;
}

std::string pack_report(const TrialReport& report) {
  return json::array(
             {report.row, static_cast<int>(report.outcome), report.message, report.seconds, report.stage_seconds})
      .dump(-1, ' ', true, json::error_handler_t::replace);
}

TrialReport unpack_report(const std::string& line) {
  const json packed = json::parse(line);
  return {packed.at(0), static_cast<TrialOutcome>(packed.at(1).get<int>()), packed.at(2), packed.at(3), packed.at(4)};
}

int run_study_worker(int argc, char** argv) try {
  constexpr int words = 4;
  if (argc != words) return 2;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != std::atoi(argv[2])) return 1;  // the parent process had already ended
  spdlog::set_level(spdlog::level::off);            // without this, each of a thousand trials would print the same
                                                    // messages
  const WorkerTask task = unpack_task(read_input());
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, task.threads);
  Worker(task).run(static_cast<std::size_t>(std::atoll(argv[3])));
  return 0;
} catch (const std::exception& error) {
  write_line(pack_report({.outcome = TrialOutcome::broken, .message = error.what()}) + "\n");
  return 1;
}

}  // namespace modebank::app
