#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace modebank {

/// One kind of ground under a tyre.
struct GroundKind {
  double friction = 0.6;    ///< friction coefficient mu, above 0
  double shear_m = 0.005;   ///< shear deformation modulus K [m], above 0; after this slip travel the force is 63 % of
                            ///< mu N
  double resistance = 0.0;  ///< motion resistance divided by the normal load, at least 0
};

/// An endless plane of square tiles. The kind of each tile is drawn independently, and all kinds are equally likely.
/// The draw depends on the seed and the tile alone.
class Ground {
 public:
  /// Requires at least one kind. With tile_m = 0 the whole plane is of the kind `everywhere`.
  Ground(std::vector<GroundKind> kinds, double tile_m, int everywhere, std::uint64_t seed)
      : kinds_(std::move(kinds)), tile_m_(tile_m), everywhere_(everywhere), seed_(seed) {}

  /// The index in `kinds` of the ground at (x, y) [m].
  int kind_at(double x_m, double y_m) const;
  const GroundKind& operator[](int kind) const { return kinds_[static_cast<std::size_t>(kind)]; }

 private:
  std::vector<GroundKind> kinds_;
  double tile_m_;
  int everywhere_;
  std::uint64_t seed_;
};

}  // namespace modebank
