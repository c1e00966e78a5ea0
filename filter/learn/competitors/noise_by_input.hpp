#pragma once

#include <cstdint>

#include "filter/step/noise_factor.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/terms.hpp"
#include "modebank/base/names.hpp"

namespace modebank {

/// automatic: one factor on all process noise follows state and input where training runs left out gain by it; none:
/// nothing is asked.
enum class NoiseByInput { automatic, none };

template <>
struct EnumNames<NoiseByInput> {
  static constexpr Names<2> values{"auto", "none"};
};

/// The likeliest factor on the noise of one motion (method: section 2a, item 5): Huber's theta of the structure and
/// the terms, then maximum likelihood of Student t residuals whose scale is exp(g'z / 2). z: logarithms of the newest
/// states, the newest inputs, their changes where the structure has the input before, and what each state's inputs add
/// to the forecast. Empty where all residuals are zero. Throws DataError without a transition to learn from.
NoiseFactor fit_noise_factor(const Recording& recording, const LinearStructure& structure,
                             const MotionTerms& terms = {});

/// The factor, if training runs that were left out gain by it.
struct FoundNoiseFactor {
  NoiseFactor factor;                    ///< empty: not taken
  double gain = not_a_number;            ///< of runs left out; of all runs where that is not enough [nats/sample]
  double standard_error = not_a_number;  ///< over the runs left out; NaN where none were
};

/// Compares one motion whose noise switches between four levels by itself, with and without the factor. Taken where it
/// is worth it on runs left out (left_out/rule.hpp). Nothing is asked of rounded or weighted samples. Learns from at
/// most 20,000 transitions, drawn with the seed.
FoundNoiseFactor find_noise_factor(const Recording& recording, const LinearStructure& structure, Eigen::Index folds,
                                   std::uint64_t seed);

}  // namespace modebank
