#include "io/hdf5/lookup3.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace modebank::hdf5 {

namespace {

using State = std::array<std::uint32_t, 3>;

void mix(State& state) {
  auto& [a, b, c] = state;
  a -= c, a ^= std::rotl(c, 4), c += b;
  b -= a, b ^= std::rotl(a, 6), a += c;
  c -= b, c ^= std::rotl(b, 8), b += a;
  a -= c, a ^= std::rotl(c, 16), c += b;
  b -= a, b ^= std::rotl(a, 19), a += c;
  c -= b, c ^= std::rotl(b, 4), b += a;
}

void finish(State& state) {
  auto& [a, b, c] = state;
  c ^= b, c -= std::rotl(b, 14);
  a ^= c, a -= std::rotl(c, 11);
  b ^= a, b -= std::rotl(a, 25);
  c ^= b, c -= std::rotl(b, 16);
  a ^= c, a -= std::rotl(c, 4);
  b ^= a, b -= std::rotl(a, 14);
  c ^= b, c -= std::rotl(b, 24);
}

}  // namespace

std::uint32_t lookup3(const unsigned char* bytes, std::size_t count) {
  constexpr std::size_t block = 12;
  State state;
  state.fill(0xdeadbeef + static_cast<std::uint32_t>(count));
  if (count == 0) return state[2];
  for (;; bytes += block, count -= block) {
    const std::size_t here = std::min(count, block);
    for (std::size_t i = 0; i < here; ++i) state[i / 4] += static_cast<std::uint32_t>(bytes[i]) << 8 * (i % 4);
    if (count <= block) break;
    mix(state);
  }
  finish(state);
  return state[2];
}

}  // namespace modebank::hdf5
