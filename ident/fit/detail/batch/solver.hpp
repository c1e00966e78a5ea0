#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "ident/fit/detail/batch/kernels.hpp"
#include "ident/fit/options.hpp"
#include "ident/fit/prior.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// Memory that one thread works in; it grows to what the chunks need and is then used again.
class BatchWorkspace {
 public:
  /// Lays the transitions that `windows` windows from transition `start` on cover side by side, in columns with
  /// padding; those with a NaN or infinity become zeros that are marked as absent.
  batch::Chunk stage(const Trajectory& run, Index start, Index windows, const LinearStructure& structure,
                     const batch::Settings& settings);
  double* scratch(Index length);

 private:
  Transitions transitions_;
  Eigen::VectorXd present_;
  std::vector<double> scratch_;
};

/// Fits consecutive windows of models that are linear in their parameters, a vector of windows at a time (one state):
/// same objective, same definitions as fit_window, by Newton's method from each window's own (posterior) least squares;
/// non-convex losses from its Huber optimum. A window's result depends on that window alone, bit by bit, whatever the
/// chunk. Windows it cannot answer for (short of samples, ill-conditioned beyond 1e5, rank deficient without a prior,
/// not converged to a gradient of 1e-10 in orthonormal coordinates relative to |psi|) get a verdict that says so, and
/// are the caller's.
class BatchSolver {
 public:
  /// Whether there are kernels for such models and windows.
  static bool handles(const LinearStructure& structure, Index length);

  /// Throws std::invalid_argument where handles() is false.
  explicit BatchSolver(batch::Settings settings);

  const batch::Settings& settings() const { return settings_; }
  /// Allocates nothing.
  void operator()(const batch::Chunk& chunk, double* scratch, const batch::Output& out) const {
    kernel_(settings_, chunk, scratch, out);
  }

 private:
  batch::Settings settings_;
  batch::Kernel kernel_;
};

/// The settings that options, loss, prior (may be null) and floor make for windows of one state.
batch::Settings batch_settings(const LinearStructure& structure, const FitOptions& options, const ParameterPrior* prior,
                               double floor);

}  // namespace modebank
