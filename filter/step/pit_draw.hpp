#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>

namespace modebank {

/// Seed of the draws of one run.
std::uint64_t pit_seed(std::uint64_t seed, std::string_view run);

/// The transform of a quantised measurement is an interval (predicted_mixture.hpp): moves `pit` (n_y) from the middle
/// of intervals of `width` (n_y) to a point drawn uniformly within them, which makes it uniform in a true filter. The
/// draw depends on `of_run` (pit_seed) and the sample's number alone. Leaves continuous signals, of width 0, alone.
void draw_pit(std::uint64_t of_run, Eigen::Index sample, const Eigen::Ref<const Eigen::VectorXd>& width,
              Eigen::Ref<Eigen::VectorXd> pit);

}  // namespace modebank
