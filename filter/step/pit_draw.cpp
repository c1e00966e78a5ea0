#include "filter/step/pit_draw.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "ident/base/seed.hpp"

namespace modebank {

std::uint64_t pit_seed(std::uint64_t seed, std::string_view run) {
  return derive_seed(seed, "pit of " + std::string(run));
}

void draw_pit(std::uint64_t of_run, Eigen::Index sample, const Eigen::Ref<const Eigen::VectorXd>& width,
              Eigen::Ref<Eigen::VectorXd> pit) {
  std::mt19937_64 generator = make_generator(of_run, "pit", static_cast<std::uint64_t>(sample));
  for (Eigen::Index i = 0; i < pit.size(); ++i) {
    const double draw = std::ldexp(static_cast<double>(generator() >> 11U), -53);
    if (width(i) > 0.0) pit(i) = std::clamp(pit(i) + (draw - 0.5) * width(i), 0.0, 1.0);
  }
}

}  // namespace modebank
