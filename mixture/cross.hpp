#pragma once

#include "mixture/gaussian_mixture.hpp"

namespace modebank {

/// A mixture that has what two mixtures of the same K, features and type agree on, and of the rest what differs most:
/// the components of both at half their weight, the two closest merged (reduction.hpp) until K are left. Mixtures that
/// are the same give themselves. Time K^2 per merge.
GaussianMixture cross(const GaussianMixture& a, const GaussianMixture& b);

}  // namespace modebank
