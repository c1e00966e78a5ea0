#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace modebank::app {

/// A file in memory with a task for workers (pack_task), which they read as standard input.
class TaskFile {
 public:
  /// Throws DataError when memory or the file system fails.
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
  /// `first`: index of the first row of the task that this process works on. Throws DataError if the process cannot be
  /// started.
  WorkerProcess(const TaskFile& task, std::size_t first);
  /// Kills and reaps the process.
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  pid_t process() const { return process_; }
  int channel() const { return channel_; }
  void kill() const;

  /// Complete lines received since the last call; nullopt after the process has ended.
  std::optional<std::vector<std::string>> read_lines();
  /// How the process ended, after read_lines() returned nullopt: empty for a normal end, else "its process was ended by
  /// signal 9 (Killed)". It is not reaped yet, so that others leave its trial to this program.
  std::string end() const;

 private:
  pid_t process_ = -1;
  int channel_ = -1;
  std::string unread_;
};

}  // namespace modebank::app
