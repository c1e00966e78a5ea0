#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

namespace modebank {

/// Seed for one use of randomness. It is derived from the configured seed, the name of the use and an index: FNV-1a of
/// the name, mixed by SplitMix64 (Steele 2014). Every random generator starts from such a seed, so results do not
/// depend on threads or on the order of work.
std::uint64_t derive_seed(std::uint64_t seed, std::string_view use, std::uint64_t index = 0);

inline std::mt19937_64 make_generator(std::uint64_t seed, std::string_view use, std::uint64_t index = 0) {
  return std::mt19937_64(derive_seed(seed, use, index));
}

/// Divides 0 .. size - 1 into `count` equal shares and draws one position from each, in order. Draws fewer positions if
/// a share would be shorter than one.
std::vector<std::ptrdiff_t> one_of_each_share(std::ptrdiff_t size, std::ptrdiff_t count, std::mt19937_64& generator);

}  // namespace modebank
