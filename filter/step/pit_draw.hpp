#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>

namespace modebank {

/// Seed for the draws of one run.
std::uint64_t pit_seed(std::uint64_t seed, std::string_view run);

/// Draws the transform of a quantised measurement within its interval (predicted_mixture.hpp). Moves `pit` (n_y) from
/// the middle of an interval of `width` (n_y) to a uniformly drawn point of the interval. If the model is correct, the
/// transform is then uniform. The draw depends only on `of_run` (pit_seed) and the sample's number. Continuous signals
/// (width 0) do not change.
void draw_pit(std::uint64_t of_run, Eigen::Index sample, const Eigen::Ref<const Eigen::VectorXd>& width,
              Eigen::Ref<Eigen::VectorXd> pit);

}  // namespace modebank
