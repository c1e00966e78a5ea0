#pragma once

#include "modebank/base/error.hpp"

namespace modebank {

/// For reading what another process may replace meanwhile, on a file system where the old content is gone then (ESTALE
/// of network file systems): the second look finds the new file, and its error counts.
template <class Look>
auto look_twice(const Look& look) {
  try {
    return look();
  } catch (const DataError&) {
    return look();
  }
}

}  // namespace modebank
