#pragma once

#include <cstdint>

#include "filter/step/bank.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/terms.hpp"
#include "modebank/base/names.hpp"

namespace modebank {

/// automatic: one factor on all process noise depends on state and input, if it gains on training runs that were left
/// out. none: no factor.
enum class NoiseByInput { automatic, none };

template <>
struct EnumNames<NoiseByInput> {
  static constexpr Names<2> values{"auto", "none"};
};

/// The most likely factor on the noise of one motion (method: section 2a, item 5). First theta is Huber's estimate for
/// the structure and the terms. Then the factor maximises the likelihood of Student t residuals with scale exp(g'z /
/// 2). z holds logarithms of the newest states, the newest inputs, their changes (if the structure has the previous
/// input), and each state's forecast contribution from inputs. Empty if all residuals are zero. Throws DataError
/// without usable transitions.
NoiseFactor fit_noise_factor(const Recording& recording, const LinearStructure& structure,
                             const MotionTerms& terms = {});

/// The factor, if training runs that were left out gain by it.
struct FoundNoiseFactor {
  NoiseFactor factor;                    ///< empty: rejected
  double gain = not_a_number;            ///< gain on left-out runs [nats/sample]. If the factor was rejected without
                                         ///< cross-validation, gain on all runs
  double standard_error = not_a_number;  ///< standard error of the gain over the left-out runs; NaN if no run was left
                                         ///< out
};

/// Compares one motion whose noise switches between four levels with and without the factor. The factor is accepted if
/// the rule for additions accepts it on runs that were left out (left_out/rule.hpp). Rounded samples are
/// not tested. Learns from at most 20,000 transitions drawn by the seed.
FoundNoiseFactor find_noise_factor(const Recording& recording, const LinearStructure& structure, Eigen::Index folds,
                                   std::uint64_t seed);

}  // namespace modebank
