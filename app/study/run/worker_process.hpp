#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace modebank::app {

/// A file in memory with a task for workers (pack_task), which they get as standard input.
class TaskFile {
 public:
  /// Throws DataError.
  explicit TaskFile(const std::string& bytes);
  ~TaskFile();
  TaskFile(const TaskFile&) = delete;
  TaskFile& operator=(const TaskFile&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_ = -1;
};

/// A process of this program that works on trials (study_worker.hpp), and the pipe on which it reports.
class WorkerProcess {
 public:
  /// `first`: the row that it begins with. Throws DataError when it cannot be started.
  WorkerProcess(const TaskFile& task, std::size_t first);
  /// Kills and reaps it.
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  pid_t process() const { return process_; }
  int channel() const { return channel_; }
  void kill() const;

  /// Whole lines that have arrived; nothing after the process has ended.
  std::optional<std::vector<std::string>> read_lines();
  /// How it ended, once read_lines() gives nothing: empty when well, else "its process was ended by signal 9
  /// (Killed)". The process is not reaped yet, so that others see that somebody looks after its trial.
  std::string end() const;

 private:
  pid_t process_ = -1;
  int channel_ = -1;
  std::string unread_;
};

}  // namespace modebank::app
