#pragma once

#include <cstddef>

namespace modebank::test {

/// How many cases a law is tried on: all in release, fewer in the debug, coverage and sanitizer builds, which take up
/// to fifty times as long and look at the same code each time. For numbers of cases only: bounds are the same in every
/// build.
constexpr std::ptrdiff_t in_release(std::ptrdiff_t all, std::ptrdiff_t otherwise) {
#ifdef NDEBUG
  return static_cast<void>(otherwise), all;
#else
  return static_cast<void>(all), otherwise;
#endif
}

}  // namespace modebank::test
