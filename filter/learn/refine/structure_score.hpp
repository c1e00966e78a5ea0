#pragma once

#include <cstdint>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// How well modes of each structure predict training runs that were left out [nats/sample], and which structure is
/// taken: the incumbent, unless another gains least_structure_gain over it, and one standard error where it has as many
/// parameters or more; then the fewest lags as good as the best (fewest_modes_as_good, left_out/rule.hpp).
struct StructuresOfModes {
  std::vector<double> scores;  ///< minus infinity where nothing can be learned
  std::size_t chosen = 0;
};

inline constexpr double least_structure_gain = 0.02;  // [nats/sample]

/// One, two, four and eight modes are learned by expectation-maximisation of the switching regression from random
/// stretches of the runs; the best of these counts. `one_theta`: modes differ in noise alone. All structures are
/// learned from and scored on the same transitions, at most 10,000 of them, drawn by the seed. The same for any number
/// of threads.
StructuresOfModes compare_structures(const Recording& recording, const std::vector<LinearStructure>& structures,
                                     std::size_t incumbent, bool one_theta, std::uint64_t seed);

}  // namespace modebank
