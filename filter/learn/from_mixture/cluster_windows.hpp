#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/fit/options.hpp"
#include "mixture/select.hpp"

namespace modebank {

/// Clusters windows by the features of the options (FeatureSet). The features may come from one-lag fits of the same
/// windows. `window`: the options of `fits`.
MixtureResult cluster_windows(const Recording& recording, const WindowFits& fits, const FitOptions& window,
                              const ClusterOptions& options, std::uint64_t seed);

}  // namespace modebank
