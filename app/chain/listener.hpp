#pragma once

#include "filter/learn/chain/progress.hpp"
#include "filter/learn/chain/stage.hpp"
#include "io/archive/archive.hpp"

namespace modebank {

/// Hears what a chain does while it does it.
class Listener : public Progress {
 public:
  /// The stage's result has come into the archive.
  virtual void done(Stage, const Archive&) const {}
};

}  // namespace modebank
