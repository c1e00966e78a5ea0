#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "ident/fit_transitions.hpp"
#include "ident/window.hpp"

namespace modebank {

/// Everything that the fits of all windows of a recording share, and the fit of one of them through Ceres. Safe to use
/// from several threads.
class WindowContext {
 public:
  WindowContext(const Recording& recording, const FitOptions& options, const LinearStructure& structure,
                const GlobalModel& global);

  const Recording& recording() const { return recording_; }
  const FitOptions& options() const { return options_; }
  const Estimator& estimator() const { return estimator_; }
  const LinearStructure& structure() const { return estimator_.structure; }
  const Eigen::VectorXd& floor() const { return floor_; }
  const Trajectory& run_of(const Window& window) const { return recording_.runs[static_cast<std::size_t>(window.run)]; }
  /// sigma of a whole run; a run too short to tell has the global one.
  const Eigen::VectorXd& run_scale(Index run) const;

  /// A window's data on the way to its fit.
  struct WindowData {
    Transitions transitions;
    Decomposition decomposition;
    NoiseScale scale;
  };
  /// Transitions with a NaN or infinity are left out; nothing when none is left.
  std::optional<WindowData> load(const Window& window) const;
  LocalModel fit(const Window& window, const ParameterPrior* prior) const;
  /// theta without prior; NaN where the rank is deficient or the fit failed.
  Eigen::VectorXd unregularised_theta(const Window& window) const;

 private:
  struct RunScale {
    std::once_flag once;
    Eigen::VectorXd value;
  };
  Eigen::VectorXd window_sigma(const Window& window, const Transitions& transitions,
                               const Decomposition& decomposition) const;

  const Recording& recording_;
  const FitOptions& options_;
  const GlobalModel& global_;
  Estimator estimator_;
  Eigen::VectorXd floor_;  ///< n, least sigma
  std::unique_ptr<RunScale[]> run_scale_;
};

}  // namespace modebank
