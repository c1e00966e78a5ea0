#pragma once

#include "mixture/gaussian_mixture.hpp"
#include "modebank/mixture/mixture.hpp"

namespace modebank {

/// Converts a mixture to the public API's type. The reverse conversion throws std::invalid_argument if the parts of the
/// mixture do not fit together.
mixture::Mixture from_internal(const GaussianMixture& mixture);
GaussianMixture to_internal(const mixture::Mixture& mixture);

}  // namespace modebank
