#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/fit/options.hpp"
#include "mixture/select.hpp"

namespace modebank {

/// Clusters windows by the features that the options ask for (FeatureSet), which may be those of one-lag fits of the
/// same windows: `window` has the options that `fits` were made with. `start`: is given the cloud and returns where the
/// first restart of the candidate of its size begins; may be empty.
MixtureResult cluster_windows(const Recording& recording, const WindowFits& fits, const FitOptions& window,
                              const ClusterOptions& options, std::uint64_t seed,
                              const std::function<std::optional<GaussianMixture>(const FeatureCloud&)>& start = {});

}  // namespace modebank
