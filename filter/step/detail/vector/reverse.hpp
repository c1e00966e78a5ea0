#pragma once

#include "filter/step/detail/vector/kernels.hpp"

/// Adjoint of `predict` and `update` (kernels.hpp), for the derivative of one step's log density. These functions limit
/// values against overflow; the limits are ignored here.
namespace modebank::vector_imm {

/// Derivatives of all later terms, in the layout of ModeRows. For a symmetric matrix, row (a, b) holds the derivative
/// with respect to the single entry (a, b), which equals that for (b, a).
struct ReverseRows {
  const double* transition_to = nullptr;  ///< T, one row per next mode

  // Derivatives with respect to the filter's state. On entry, the state after the step is meant; on return, the state
  // before the step.
  double *mean = nullptr, *covariance = nullptr, *probability = nullptr;  ///< number of rows: n, packed n, 1

  // Derivatives with respect to the bank, summed over the steps.
  double *F = nullptr, *B = nullptr, *c = nullptr, *Q = nullptr;  ///< number of rows: n*n, n*inputs, n, packed n
  double* by_transition_to = nullptr;                             ///< one row per next mode
  double* R = nullptr;                                            ///< packed n_y numbers, not rows

  // Workspace.
  /// Number of rows: n, n, packed n
  double *mixed_mean = nullptr, *by_mixed_mean = nullptr, *by_mixed_covariance = nullptr;
  double *by_prior = nullptr, *pair = nullptr;  ///< 1, 1
};

/// The step to differentiate. ModeRows holds the state before this step and the results of `predict`.
struct ReverseStep {
  Sensor sensor;
  const double* inputs = nullptr;
  const double* measured = nullptr;           ///< null for a prediction without measurement
  const double* probability_after = nullptr;  ///< one row
  double weight = 1.0;                        ///< weight of the step's log density
  double noise_scale = 1.0;
  bool adaptive = false;
  double by_share = 0.0, by_square = 0.0;  ///< derivatives with respect to the sums of UpdateResult, if the noise is
                                           ///< adaptive
};

/// Adjoint of a step. Returns the derivative with respect to the noise scale on Q. The pointer is null for sizes
/// without kernels.
using Reverse = double (*)(const ModeRows&, const ReverseStep&, const ReverseRows&);
Reverse reverse(std::size_t states, std::size_t measurements);

}  // namespace modebank::vector_imm
