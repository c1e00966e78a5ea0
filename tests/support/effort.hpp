#pragma once

#include <cstddef>

namespace modebank::test {

/// Number of cases for a test: all cases in release builds, fewer in debug and sanitizer builds. Those builds
/// take up to fifty times as long and run the same code each time. Only numbers of cases may depend on this function;
/// bounds are equal in every build.
constexpr std::ptrdiff_t in_release(std::ptrdiff_t all, std::ptrdiff_t otherwise) {
#ifdef NDEBUG
  return static_cast<void>(otherwise), all;
#else
  return static_cast<void>(all), otherwise;
#endif
}

}  // namespace modebank::test
