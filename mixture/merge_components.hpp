#pragma once

#include "mixture/select.hpp"

namespace modebank {

/// Merges the closest components until at most `most` are left, each time the pair whose merge by moments (weight, mean
/// and covariance of the two together are kept) costs least by the bound of Runnalls 2007, "Kullback-Leibler approach
/// to Gaussian mixture reduction", IEEE Trans. Aerospace and Electronic Systems 43(3), eq. 21:
///   B(i, j) = 1/2 [(w_i + w_j) log det P_ij - w_i log det P_i - w_j log det P_j].
/// Responsibilities add up, labels follow the merges; the table of candidates stays. Throws std::invalid_argument for
/// `most` below 1.
MixtureResult merge_components(MixtureResult result, Eigen::Index most);

}  // namespace modebank
