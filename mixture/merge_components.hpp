#pragma once

#include "mixture/select.hpp"

namespace modebank {

/// Merges the closest components until at most `most` are left: each time the first pair of merges_by_loss
/// (component_merge.hpp), by moments.
/// Responsibilities add up, labels follow the merges; the table of candidates stays. Throws std::invalid_argument for
/// `most` below 1.
MixtureResult merge_components(MixtureResult result, Eigen::Index most);

}  // namespace modebank
