#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <optional>
#include <vector>

#include "app/study/run/trial_worker.hpp"

namespace modebank::app {

/// Processes that take trials one at a time. A trial that crashes or overruns its time ends its process only, which is
/// replaced. They end with this process, however it ends.
class WorkerPool {
 public:
  using Work = std::function<TrialReport(std::size_t trial)>;

  /// To be called when a trial begins (true) and ceases to wait for what another process does: its time stands still.
  using TellWaiting = std::function<void(bool)>;
  using MakeWork = std::function<Work(const TellWaiting&)>;

  /// `make_work` is called in every new process. timeout_s 0: no limit. The calling process must have no other thread
  /// whenever one starts: a lock that such a thread holds would stay locked in it.
  WorkerPool(std::size_t workers, double timeout_s, MakeWork make_work);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  std::size_t size() const { return workers_.size(); }
  bool is_idle(std::size_t worker) const { return !workers_[worker].trial; }
  bool is_working() const;
  void give(std::size_t worker, std::size_t trial);

  struct Finished {
    std::size_t worker, trial;
    TrialReport report;
    bool crashed = false;  ///< the process ended without a report, or was ended
  };
  /// The next trial that is finished; nothing after `patience_s` seconds.
  std::optional<Finished> wait(double patience_s);

 private:
  using Clock = std::chrono::steady_clock;
  struct Worker {
    pid_t process = -1;
    int channel = -1;
    std::optional<std::size_t> trial;
    Clock::time_point since;
    std::optional<Clock::time_point> waiting_from;
  };

  void start(Worker& worker);
  /// Ends and reaps the process; says how it ended.
  std::string end(Worker& worker, bool by_force);
  /// What the worker says: nothing, when only that it waits or no longer does.
  std::optional<Finished> collect(std::size_t index);
  /// The working worker whose time is up first; nothing without a limit.
  std::optional<std::size_t> first_due() const;
  Finished stop_overdue(std::size_t index);

  double timeout_s_;
  MakeWork make_work_;
  std::vector<Worker> workers_;
};

}  // namespace modebank::app
