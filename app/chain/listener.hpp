#pragma once

#include "io/archive/archive.hpp"

namespace modebank {

/// Receives messages and results from a running chain.
class Listener {
 public:
  virtual ~Listener() = default;
  virtual void tell(Level, const std::string&) const {}
  /// Called after the result of the stage was added to the archive.
  virtual void done(Stage, const Archive&) const {}
};

}  // namespace modebank
