#pragma once

#include <cstdint>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// Scores of modes with each structure on left-out training runs [nats/sample], and the chosen structure. The present
/// structure stays unless another one gains least_structure_gain over it. If it has at least as many parameters as the
/// present structure, it must also gain one standard error. Among structures that gain and are as good as the best, the
/// one with the fewest lags is chosen (fewest_modes_as_good, left_out/rule.hpp).
struct StructuresOfModes {
  std::vector<double> scores;  ///< minus infinity if the structure cannot be learned
  std::size_t chosen = 0;
};

inline constexpr double least_structure_gain = 0.02;  // [nats/sample]

/// Learns one, two, four and eight modes by expectation-maximisation of the switching regression, from random stretches
/// of the runs. The score is that of the best number of modes. `one_theta`: modes differ only in noise. All structures
/// use the same transitions, at most 10,000, drawn by the seed. The result is the same for any number of threads.
StructuresOfModes compare_structures(const Recording& recording, const std::vector<LinearStructure>& structures,
                                     std::size_t incumbent, bool one_theta, std::uint64_t seed);

}  // namespace modebank
