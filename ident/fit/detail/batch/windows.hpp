#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <memory>
#include <string>
#include <vector>

#include "ident/fit/detail/batch/solver.hpp"
#include "ident/fit/window_fitter.hpp"

namespace modebank {

/// The batch solver on ranges of a recording's windows. Safe to use from several threads.
class BatchWindows {
 public:
  /// A range that is long enough to pay for its staging, short enough to stay in a core's second cache.
  static constexpr Index longest_range = 1024;

  /// Null where the stage of `count` windows is Ceres' (WindowSolver). `prior` may be null. Throws ConfigurationError
  /// for WindowSolver::batch where the solver has no kernel.
  static std::unique_ptr<BatchWindows> make(const LinearWindows& windows, Index count, const ParameterPrior* prior);

  /// How it solves a window and to what tolerance, in words.
  static std::string method();

  /// Solves a range of at most longest_range windows into `out`; its verdicts are the calling thread's, until its next
  /// call.
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

/// Where the columns of `fits` from window i on lie.
batch::Output columns_from(WindowFits& fits, Index i);

}  // namespace modebank
