#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <memory>
#include <vector>

#include "ident/fit/detail/batch/solver.hpp"
#include "ident/fit/window_fitter.hpp"

namespace modebank {

/// The batch solver on ranges of a recording's windows. Thread-safe.
class BatchWindows {
 public:
  /// Largest range of windows. It is long enough to repay the copying of samples, and fits a core's second-level cache.
  static constexpr Index longest_range = 1024;

  /// The solver for `count` windows; null if the windows are left to Ceres (WindowSolver). `prior` may be null. Throws
  /// ConfigurationError for WindowSolver::batch without a matching kernel.
  static std::unique_ptr<BatchWindows> make(const LinearWindows& windows, Index count, const ParameterPrior* prior);

  /// Solves a range of at most longest_range windows and writes the fits to `out`. The verdicts belong to the calling
  /// thread and are valid until its next call.
  const std::vector<batch::Verdict>& solve(const WindowPlan::Range& range, batch::Output out);

 private:
  BatchWindows(const LinearWindows& windows, const ParameterPrior* prior);

  struct Worker {
    BatchWorkspace workspace;
    std::vector<batch::Verdict> verdict = std::vector<batch::Verdict>(static_cast<std::size_t>(longest_range));
  };

  const LinearWindows& windows_;
  BatchSolver solver_;
  tbb::enumerable_thread_specific<Worker> workers_;
};

/// Pointers to the columns of `fits` from window i on.
batch::Output columns_from(WindowFits& fits, Index i);

}  // namespace modebank
