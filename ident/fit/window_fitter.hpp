#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "ident/data/window.hpp"
#include "ident/fit/fit_window.hpp"
#include "ident/fit/motion_fit.hpp"

namespace modebank {

/// The data shared by the fits of all windows of a recording, and the fit of one window through Ceres. Holds references
/// to recording, options and global model, which must outlive it. Thread-safe.
class WindowFitter {
 public:
  virtual ~WindowFitter() = default;

  virtual LocalModel fit(const Window& window, const ParameterPrior* prior) const = 0;
  /// theta without prior; NaN if the window is rank deficient or the fit failed.
  virtual Eigen::VectorXd unregularised_theta(const Window& window) const = 0;

  const Recording& recording() const { return recording_; }
  const FitOptions& options() const { return options_; }
  const GlobalModel& global() const { return global_; }
  const Eigen::VectorXd& floor() const { return floor_; }  ///< n, smallest sigma per state
  const Trajectory& run_of(const Window& window) const { return recording_.runs[static_cast<std::size_t>(window.run)]; }
  /// Sigma of a whole run. If the run is too short for an estimate, the global sigma.
  const Eigen::VectorXd& run_scale(Index run) const;

 protected:
  /// `floor` is the result of scale_floor.
  WindowFitter(const Recording& recording, const FitOptions& options, const GlobalModel& global, Eigen::VectorXd floor);

  /// robust_scale of a run's least-squares residuals; NaN if the run is too short.
  virtual Eigen::VectorXd scale_of(const Trajectory& run) const = 0;
  /// The sigma of the options if they state one. Otherwise the scale of the window's residuals (`own`), or the sigma of
  /// the run if the window has not `enough` samples or `own` is not finite.
  Eigen::VectorXd window_sigma(const Window& window, bool enough, const std::function<Eigen::VectorXd()>& own) const;

 private:
  struct RunScale {
    std::once_flag once;
    Eigen::VectorXd value;
  };

  const Recording& recording_;
  const FitOptions& options_;
  const GlobalModel& global_;
  Eigen::VectorXd floor_;
  std::unique_ptr<RunScale[]> run_scale_;
};

/// Window fits of models that are linear in their parameters.
class LinearWindows final : public WindowFitter {
 public:
  LinearWindows(const Recording& recording, const FitOptions& options, const LinearStructure& structure,
                const GlobalModel& global);

  const Estimator& estimator() const { return estimator_; }
  const LinearStructure& structure() const { return estimator_.structure; }

  /// The data of one window, prepared for its fit.
  struct WindowData {
    Transitions transitions;
    Decomposition decomposition;
    NoiseScale scale;
  };
  /// The window's transitions without those that contain a NaN or infinity; empty if no transition remains.
  std::optional<WindowData> load(const Window& window) const;

  LocalModel fit(const Window& window, const ParameterPrior* prior) const override;
  Eigen::VectorXd unregularised_theta(const Window& window) const override;

 private:
  Eigen::VectorXd scale_of(const Trajectory& run) const override;

  Estimator estimator_;
};

/// Window fits of any motion model; searches start at the global model.
class MotionWindows final : public WindowFitter {
 public:
  MotionWindows(const Recording& recording, const FitOptions& options, const MotionModel& model,
                const GlobalModel& global);

  LocalModel fit(const Window& window, const ParameterPrior* prior) const override;
  Eigen::VectorXd unregularised_theta(const Window& window) const override;

 private:
  Eigen::VectorXd scale_of(const Trajectory& run) const override;
  /// robust_scale of least-squares residuals, with states weighted by `sigma`; NaN if there are too few samples.
  Eigen::VectorXd least_squares_scale(const ModelResiduals& residuals, const Eigen::VectorXd& sigma) const;

  const MotionModel& model_;
  ModelEstimator estimator_;
  RobustLoss least_squares_;
};

}  // namespace modebank
