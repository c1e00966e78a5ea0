#pragma once

#include "mixture/gaussian_mixture.hpp"

namespace modebank {

/// Of a mixture with more components than wanted those of the highest peak density w / sqrt(det Sigma): scattered
/// points make wide, light components, which are left to a noise component. The others' weight becomes that of the
/// noise, between 0.01 and 0.5, and none of the kept weights changes; the noise has no box yet.
GaussianMixture keep_densest(const GaussianMixture& mixture, Eigen::Index components);

/// How many components more than wanted a start has that is to be thinned so.
inline Eigen::Index spare_components(Eigen::Index components) { return components + 3; }

}  // namespace modebank
