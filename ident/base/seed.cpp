#include "ident/base/seed.hpp"

#include <algorithm>

namespace modebank {

namespace {

/// Finaliser of SplitMix64 (Steele, Lea & Flood 2014) after one step of its Weyl sequence.
std::uint64_t splitmix64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31U);
}

/// 64-bit FNV-1a (Fowler, Noll & Vo).
std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : text) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3ULL;
  }
  return hash;
}

}  // namespace

std::uint64_t derive_seed(std::uint64_t seed, std::string_view use, std::uint64_t index) {
  return splitmix64(splitmix64(splitmix64(seed) ^ fnv1a(use)) ^ index);
}

std::vector<std::ptrdiff_t> one_of_each_share(std::ptrdiff_t size, std::ptrdiff_t count, std::mt19937_64& generator) {
  std::vector<std::ptrdiff_t> drawn;
  for (std::ptrdiff_t share = 0; share < count; ++share) {
    const double draw = static_cast<double>(generator() >> 11U) * 0x1p-53;
    const double at = (static_cast<double>(share) + draw) * static_cast<double>(size) / static_cast<double>(count);
    const std::ptrdiff_t position = std::min(size - 1, static_cast<std::ptrdiff_t>(at));
    if (drawn.empty() || drawn.back() != position) drawn.push_back(position);
  }
  return drawn;
}

}  // namespace modebank
