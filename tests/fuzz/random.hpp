#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>

#include "ident/base/seed.hpp"

namespace modebank::fuzz {

/// Numbers for one input, cheap to begin anew (SplitMix64, Steele 2014): input i of a seed is made from these two
/// alone, so that it can be made again without those before it.
class Random {
 public:
  explicit Random(std::uint64_t state) : state_(state) {}
  Random(std::uint64_t seed, std::uint64_t iteration) : Random(derive_seed(seed, "fuzz", iteration)) {}

  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return z ^ z >> 31;
  }
  /// 0 .. end - 1; 0 where end is 0.
  std::size_t below(std::size_t end) { return end == 0 ? 0 : static_cast<std::size_t>(next() % end); }
  bool one_in(std::size_t count) { return below(count) == 0; }
  template <class List>
  const auto& pick(const List& list) {
    return *(list.begin() + static_cast<std::ptrdiff_t>(below(list.size())));
  }
  template <class T>
  T pick(std::initializer_list<T> list) {
    return *(list.begin() + below(list.size()));
  }

 private:
  std::uint64_t state_;
};

}  // namespace modebank::fuzz
