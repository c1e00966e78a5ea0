#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "ident/data/window.hpp"
#include "ident/fit/fit_window.hpp"
#include "ident/fit/motion_fit.hpp"

namespace modebank {

/// Everything that the fits of all windows of a recording share, and the fit of one of them through Ceres. Refers to
/// recording, options and global model, which must outlive it. Safe to use from several threads.
class WindowFitter {
 public:
  virtual ~WindowFitter() = default;

  virtual LocalModel fit(const Window& window, const ParameterPrior* prior) const = 0;
  /// theta without prior; NaN where the rank is deficient or the fit failed.
  virtual Eigen::VectorXd unregularised_theta(const Window& window) const = 0;

  /// Who solves a window to what tolerance, in words.
  virtual std::string method() const;

  const Recording& recording() const { return recording_; }
  const FitOptions& options() const { return options_; }
  const GlobalModel& global() const { return global_; }
  const Eigen::VectorXd& floor() const { return floor_; }  ///< n, least sigma
  const Trajectory& run_of(const Window& window) const { return recording_.runs[static_cast<std::size_t>(window.run)]; }
  /// sigma of a whole run; a run too short to tell has the global one.
  const Eigen::VectorXd& run_scale(Index run) const;

 protected:
  /// `floor` as scale_floor makes it.
  WindowFitter(const Recording& recording, const FitOptions& options, const GlobalModel& global, Eigen::VectorXd floor);

  /// robust_scale of a run's least-squares residuals; NaN where it is too short to tell.
  virtual Eigen::VectorXd scale_of(const Trajectory& run) const = 0;
  /// sigma as the options say: `own`, the scale of the window's own residuals, where they ask for it, the window has
  /// `enough` of them and it is finite; else the run's.
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

/// Windows of models that are linear in their parameters.
class LinearWindows final : public WindowFitter {
 public:
  LinearWindows(const Recording& recording, const FitOptions& options, const LinearStructure& structure,
                const GlobalModel& global);

  const Estimator& estimator() const { return estimator_; }
  const LinearStructure& structure() const { return estimator_.structure; }

  /// A window's data on the way to its fit.
  struct WindowData {
    Transitions transitions;
    Decomposition decomposition;
    NoiseScale scale;
  };
  /// Transitions with a NaN or infinity are left out; nothing when none is left.
  std::optional<WindowData> load(const Window& window) const;

  LocalModel fit(const Window& window, const ParameterPrior* prior) const override;
  Eigen::VectorXd unregularised_theta(const Window& window) const override;

 private:
  Eigen::VectorXd scale_of(const Trajectory& run) const override;

  Estimator estimator_;
};

/// Windows of any motion model; searches start at the global model.
class MotionWindows final : public WindowFitter {
 public:
  MotionWindows(const Recording& recording, const FitOptions& options, const MotionModel& model,
                const GlobalModel& global);

  LocalModel fit(const Window& window, const ParameterPrior* prior) const override;
  Eigen::VectorXd unregularised_theta(const Window& window) const override;
  std::string method() const override { return minimise_model_method; }

 private:
  Eigen::VectorXd scale_of(const Trajectory& run) const override;
  /// robust_scale of the residuals of least squares that weighs the states by `sigma`; NaN when there are too few.
  Eigen::VectorXd least_squares_scale(const ModelResiduals& residuals, const Eigen::VectorXd& sigma) const;

  const MotionModel& model_;
  ModelEstimator estimator_;
  RobustLoss least_squares_;
};

}  // namespace modebank
