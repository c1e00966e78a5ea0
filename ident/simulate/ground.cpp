#include "ident/simulate/ground.hpp"

#include <cmath>

#include "ident/base/seed.hpp"

namespace modebank {

namespace {

/// Tile numbers beyond 2^31 wrap around; such tiles are thousands of kilometres away.
std::uint64_t tile_number(double x, double y) {
  const auto column = static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(x)));
  const auto row = static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(y)));
  return (column << 32) ^ (row & 0xffffffffULL);
}

}  // namespace

int Ground::kind_at(double x_m, double y_m) const {
  if (tile_m_ == 0.0) return everywhere_;
  if (kinds_.size() == 1) return 0;
  const std::uint64_t draw = derive_seed(seed_, "ground.tile", tile_number(x_m / tile_m_, y_m / tile_m_));
  return static_cast<int>(draw % kinds_.size());
}

}  // namespace modebank
