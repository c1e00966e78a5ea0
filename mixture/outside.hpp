#pragma once

#include "mixture/gaussian_mixture.hpp"
#include "modebank/mixture/mixture.hpp"

namespace modebank {

/// A mixture as programs get it, and back. The way back throws std::invalid_argument where its parts do not fit.
mixture::Mixture outside(const GaussianMixture& mixture);
GaussianMixture inside(const mixture::Mixture& mixture);

}  // namespace modebank
