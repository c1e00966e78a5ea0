#pragma once

#include <sys/types.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace modebank::app {

/// A file in memory with a task (pack_task). Workers read it as standard input.
class TaskFile {
 public:
  /// Throws DataError if there is not enough memory or the file cannot be made.
  explicit TaskFile(const std::string& bytes);
  ~TaskFile();
  TaskFile(const TaskFile&) = delete;
  TaskFile& operator=(const TaskFile&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_ = -1;
};

/// A process of this program that runs trials (study_worker.hpp), and the pipe for its reports.
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

  /// The complete lines since the last call; nullopt if the process has ended.
  std::optional<std::vector<std::string>> read_lines();
  /// How the process ended. Call this after read_lines() has returned nullopt. Empty for a normal end, else for example
  /// "its process was ended by signal 9 (Killed)". The process is not reaped yet, so other processes do not take its
  /// trial.
  std::string end() const;

 private:
  pid_t process_ = -1;
  int channel_ = -1;
  std::string unread_;
};

}  // namespace modebank::app
