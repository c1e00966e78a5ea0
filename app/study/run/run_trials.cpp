#include "app/study/run/run_trials.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <deque>
#include <memory>
#include <thread>

#include "app/study/run/worker_pool.hpp"
#include "io/files/csv_field.hpp"
#include "io/files/replace_file.hpp"

namespace modebank::app {
namespace {

using Rows = std::deque<std::size_t>;

/// Which trial a worker takes next.
class TrialQueue {
 public:
  TrialQueue(const TrialGroups& groups, std::size_t workers) : own_(workers) {
    for (const auto& group : groups) groups_.emplace_back(group.begin(), group.end());
  }

  std::optional<std::size_t> next(std::size_t worker) {
    Rows& own = own_[worker];
    if (own.empty() && !groups_.empty()) {
      own = std::move(groups_.front());
      groups_.pop_front();
    } else if (own.empty()) {
      split_largest(own);
    }
    if (own.empty()) return std::nullopt;
    const std::size_t row = own.front();
    own.pop_front();
    return row;
  }

  /// Another process is at this group: its rest comes after all the others.
  void put_off(std::size_t worker, std::size_t row) {
    held_.push_back(row);
    if (!own_[worker].empty()) groups_.push_back(std::exchange(own_[worker], {}));
  }

  /// Rows that other processes held, to be tried again.
  bool retry_held() {
    if (held_.empty()) return false;
    groups_.push_back(std::exchange(held_, {}));
    return true;
  }

 private:
  /// Half of what the busiest worker still has.
  void split_largest(Rows& own) {
    Rows& largest =
        *std::max_element(own_.begin(), own_.end(), [](const Rows& a, const Rows& b) { return a.size() < b.size(); });
    if (largest.empty()) return;
    const auto middle = largest.begin() + static_cast<std::ptrdiff_t>(largest.size() / 2);
    own.assign(middle, largest.end());
    largest.erase(middle, largest.end());
  }

  std::deque<Rows> groups_;
  std::vector<Rows> own_;
  Rows held_;
};

/// One line per trial and execution: when, host, process, key, outcome, seconds, those of each stage (0: there
/// already), message. The estimates of time are made from it (study_estimate.cpp). Losing a line loses nothing else.
void log_trial(const TrialStore& store, const FileLocks& locks, const TrialRow& row, const TrialReport& report) {
  static constexpr std::array<const char*, 5> words{"held", "present", "done", "failed", "stopped"};
  char host[256] = "";
  ::gethostname(host, sizeof host - 1);
  const FileLocks::Hold alone = locks.lock("log");  // appending from two machines is no one step everywhere
  const std::string line =
      fmt::format("{:%Y-%m-%dT%H:%M:%SZ},{},{},{},{},{:.6g},{:.6g},{}\n", fmt::gmtime(std::time(nullptr)),
                  csv_field(host), ::getpid(), row.key, words[static_cast<std::size_t>(report.outcome)], report.seconds,
                  fmt::join(report.stage_seconds, ","), csv_field(report.message));
  try {
    append_to_file(store.log(), line);
  } catch (const std::exception& error) {
    spdlog::debug("{}: {}", store.log().string(), error.what());
  }
}

/// The threads of one trial, when several run at a time.
std::size_t threads_per_trial(const Config& study) {
  if (study.job.threads > 0) return study.job.thread_count();
  return std::max<std::size_t>(1, study.job.thread_count() / job_count(study.study));
}

WorkerPool::Work make_work(const WorkerSettings& settings, const std::vector<TrialRow>& rows,
                           const WorkerPool::TellWaiting& tell_waiting) {
  spdlog::set_level(spdlog::level::off);  // a thousand trials would each say the same
  const auto limit = std::make_shared<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                           threads_per_trial(settings.config));
  const auto worker = std::make_shared<TrialWorker>(settings, tell_waiting);
  return [limit, worker, &rows](std::size_t row) { return worker->take(rows[row]); };
}

/// Runs one share to its end.
class StudyRun {
 public:
  StudyRun(const WorkerSettings& settings, const StudyPlan& plan, const TrialGroups& groups,
           const TrialListener& listener)
      : settings_(settings),
        rows_(plan.table.rows),
        listener_(listener),
        locks_(settings.store.lock_file()),
        all_(count(groups)),
        pool_(std::min(job_count(settings.config.study), std::max<std::size_t>(all_, 1)),
              settings.config.study.timeout_s,
              [this](const auto& tell_waiting) { return make_work(settings_, rows_, tell_waiting); }),
        queue_(groups, pool_.size()) {}

  RunResult run() {
    const auto start = std::chrono::steady_clock::now();
    while (finished_ < all_ || pool_.is_working()) {
      if (!stopping_) hand_out();
      if (stopping_ && !pool_.is_working()) break;
      if (!pool_.is_working()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));  // others hold what is left
        queue_.retry_held();
        continue;
      }
      constexpr double patience_s = 1.0;
      if (const auto done = pool_.wait(patience_s)) take(*done);
    }
    result_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return std::move(result_);
  }

 private:
  static std::size_t count(const TrialGroups& groups) {
    std::size_t trials = 0;
    for (const auto& group : groups) trials += group.size();
    return trials;
  }

  void hand_out() {
    for (std::size_t worker = 0; worker < pool_.size(); ++worker)
      if (pool_.is_idle(worker))
        if (const auto row = queue_.next(worker)) pool_.give(worker, *row);
  }

  void take(const WorkerPool::Finished& done) {
    const TrialRow& row = rows_[done.trial];
    if (done.report.outcome == TrialOutcome::held) return queue_.put_off(done.worker, done.trial);
    ++finished_;
    sort_in(row, done);
    if (done.report.outcome != TrialOutcome::present) log_trial(settings_.store, locks_, row, done.report);
    listener_(row, done.report, finished_, all_);
  }

  void sort_in(const TrialRow& row, const WorkerPool::Finished& done) {
    switch (done.report.outcome) {
      case TrialOutcome::present:
        ++result_.present;
        result_.whole.push_back(row.key);
        break;
      case TrialOutcome::computed:
        ++result_.computed;
        result_.whole.push_back(row.key);
        break;
      case TrialOutcome::failed:
        if (done.crashed) settings_.store.record_failure(row.key, {done.report.message, settings_.execution});
        result_.failed.push_back(done.trial);
        stopping_ = stopping_ || settings_.config.study.on_failure == OnFailure::stop;
        break;
      default:
        result_.broken = done.report.message;
        stopping_ = true;
    }
  }

  const WorkerSettings& settings_;
  const std::vector<TrialRow>& rows_;
  const TrialListener& listener_;
  const FileLocks locks_;
  std::size_t all_, finished_ = 0;
  bool stopping_ = false;
  RunResult result_;
  WorkerPool pool_;
  TrialQueue queue_;
};

}  // namespace

std::size_t job_count(const StudyConfig& study) {
  return study.jobs > 0 ? static_cast<std::size_t>(study.jobs) : std::max(1u, std::thread::hardware_concurrency());
}

RunResult run_trials(const WorkerSettings& settings, const StudyPlan& plan, const TrialGroups& groups,
                     const TrialListener& listener) {
  return StudyRun(settings, plan, groups, listener).run();
}

}  // namespace modebank::app
