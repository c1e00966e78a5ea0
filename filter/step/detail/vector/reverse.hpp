#pragma once

#include "filter/step/detail/vector/kernels.hpp"

/// The derivative of one step's log density backwards: the adjoint of what `predict` and `update` (kernels.hpp) do,
/// whose rounding guards against overflow it takes for not there.
namespace modebank::vector_imm {

/// Derivatives of everything later than a moment, in rows as those of ModeRows. Of a symmetric matrix row (a, b) holds
/// the derivative by each of the entries (a, b) and (b, a).
struct ReverseRows {
  const double* transition_to = nullptr;  ///< a row per mode: to; T itself
  // By the filter's state: on entry after the step, on return before it.
  double *mean = nullptr, *covariance = nullptr, *probability = nullptr;  ///< n, packed n, 1
  // By the bank: sums.
  double *F = nullptr, *B = nullptr, *c = nullptr, *Q = nullptr;  ///< n*n, n*inputs, n, packed n
  double* by_transition_to = nullptr;                             ///< a row per mode: to
  double* R = nullptr;                                            ///< packed n_y numbers, no rows
  // Workspace.
  double *mixed_mean = nullptr, *by_mixed_mean = nullptr, *by_mixed_covariance = nullptr;  ///< n, n, packed n
  double *by_prior = nullptr, *pair = nullptr;                                             ///< 1, 1
};

/// The step to go back over, of which ModeRows holds the state before it and what `predict` left.
struct ReverseStep {
  Sensor sensor;
  const double* inputs = nullptr;
  const double* measured = nullptr;           ///< null: a prediction only
  const double* probability_after = nullptr;  ///< a row
  double weight = 1.0;                        ///< of the log density
  double noise_scale = 1.0;
  bool adaptive = false;
  double by_share = 0.0, by_square = 0.0;  ///< derivatives by UpdateResult's sums, if adaptive
};

/// Goes back over a step; returns the derivative by the noise scale that Q was multiplied by. Null for sizes without
/// kernels.
using Reverse = double (*)(const ModeRows&, const ReverseStep&, const ReverseRows&);
Reverse reverse(std::size_t states, std::size_t measurements);

}  // namespace modebank::vector_imm
