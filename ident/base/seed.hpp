#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

namespace modebank {

/// Seed of one use of randomness, derived from the configured seed, the name of the use and an index. All random
/// generators start from such a seed, so results do not depend on threads or the order of work. FNV-1a of the name,
/// mixed by SplitMix64 (Steele 2014).
std::uint64_t derive_seed(std::uint64_t seed, std::string_view use, std::uint64_t index = 0);

inline std::mt19937_64 make_generator(std::uint64_t seed, std::string_view use, std::uint64_t index = 0) {
  return std::mt19937_64(derive_seed(seed, use, index));
}

/// Draws one position from each of `count` equal shares of 0 .. size - 1, in order. Draws fewer if a share would be
/// shorter than one.
std::vector<std::ptrdiff_t> one_of_each_share(std::ptrdiff_t size, std::ptrdiff_t count, std::mt19937_64& generator);

}  // namespace modebank
