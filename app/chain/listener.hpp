#pragma once

#include <chrono>
#include <string>

#include "app/chain/stage_key.hpp"
#include "io/archive/archive.hpp"

namespace modebank {

/// Hears what a chain does while it does it.
class Listener {
 public:
  virtual ~Listener() = default;
  /// One line on how it goes on.
  virtual void progress(const std::string&) const {}
  /// One line on something that was tried on the way.
  virtual void detail(const std::string&) const {}
  /// One line on what may need a look.
  virtual void warning(const std::string&) const {}
  /// The stage's result has come into the archive.
  virtual void done(Stage, const Archive&) const {}
};

/// Wall time since it was made, for lines of progress.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace modebank
