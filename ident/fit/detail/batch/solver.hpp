#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "ident/fit/detail/batch/kernels.hpp"
#include "ident/fit/options.hpp"
#include "ident/fit/prior.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// Memory of one thread; it grows to the size of the largest chunk and is reused.
class BatchWorkspace {
 public:
  /// Copies the transitions of `windows` windows from transition `start` on into padded columns. Transitions with a NaN
  /// or infinity become zeros marked as absent.
  batch::Chunk stage(const Trajectory& run, Index start, Index windows, const LinearStructure& structure,
                     const batch::Settings& settings);
  double* scratch(Index length);

 private:
  Transitions transitions_;
  Eigen::VectorXd present_;
  std::vector<double> scratch_;
};

/// Fits consecutive windows of models that are linear in their parameters (one state), a vector of windows at a time.
/// Objective and definitions are those of fit_window. Newton's method starts from each window's (posterior) least
/// squares; for non-convex losses it starts from the Huber optimum. A window's result depends on that window alone, to
/// the last bit. Convergence is a gradient of 1e-10 |psi| in orthonormal coordinates. The caller must solve all windows
/// whose verdict is not `solved`. These windows have too few samples, a condition above 1e5, rank-deficient regressors
/// without a prior, or no convergence.
class BatchSolver {
 public:
  /// Whether kernels exist for such models and windows.
  static bool handles(const LinearStructure& structure, Index length);

  /// Throws std::invalid_argument unless handles() is true.
  explicit BatchSolver(batch::Settings settings);

  const batch::Settings& settings() const { return settings_; }
  /// Fits a chunk; does not allocate.
  void operator()(const batch::Chunk& chunk, double* scratch, const batch::Output& out) const {
    kernel_(settings_, chunk, scratch, out);
  }

 private:
  batch::Settings settings_;
  batch::Kernel kernel_;
};

/// Settings for windows of one state from options, loss, prior (may be null) and floor.
batch::Settings batch_settings(const LinearStructure& structure, const FitOptions& options, const ParameterPrior* prior,
                               double floor);

}  // namespace modebank
