#pragma once

#include "mixture/select.hpp"

namespace modebank {

/// Merges the closest components until at most `most` are left: by moments, the pair of least merge_loss first
/// (reduction.hpp). Responsibilities add up, labels follow the merges; the table of candidates stays. Throws
/// std::invalid_argument for `most` below 1.
MixtureResult merge_components(MixtureResult result, Eigen::Index most);

}  // namespace modebank
