#pragma once

#include "filter/learn/chain/progress.hpp"
#include "filter/learn/chain/stage.hpp"
#include "io/archive/archive.hpp"

namespace modebank {

/// Receives messages and results from a running chain.
class Listener : public Progress {
 public:
  /// Called after the result of the stage was added to the archive.
  virtual void done(Stage, const Archive&) const {}
};

}  // namespace modebank
