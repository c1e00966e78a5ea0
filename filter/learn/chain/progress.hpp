#pragma once

#include <Eigen/Core>
#include <chrono>
#include <string>

namespace modebank {

/// Receives messages about the progress of learning.
class Progress {
 public:
  virtual ~Progress() = default;
  /// Receives a line about progress.
  virtual void progress(const std::string&) const {}
  /// Receives a line about an intermediate trial.
  virtual void detail(const std::string&) const {}
  /// Receives a line about a possible problem.
  virtual void warning(const std::string&) const {}
};

/// Wall time since construction, for progress messages.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// "200,000 of 2,500,000".
std::string of_all(Eigen::Index part, Eigen::Index all);

/// "from 200,000 of 2,500,000 training transitions".
std::string learned_words(Eigen::Index learned, Eigen::Index all);

}  // namespace modebank
