#pragma once

#include "ident/enum_names.hpp"

namespace modebank {

/// How the last stage of a refinement, with measurement noise (refine_measured.hpp), ended. none: there was no such
/// stage, or it did not pay. iteration_limit: bank.max_iterations came before the maximum of the likelihood. stalled:
/// no step raised the likelihood though its gradient promised more.
enum class MeasuredFit { none, converged, iteration_limit, stalled };

template <>
struct EnumNames<MeasuredFit> {
  static constexpr Names<4> values{"none", "converged", "iteration_limit", "stalled"};
};

}  // namespace modebank
