#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/motion_model.hpp"

namespace modebank {

/// Consecutive transitions of one run.
struct TransitionRange {
  const Trajectory* run = nullptr;
  Index start = 0;
  Index length = 0;
};

/// All transitions of the training runs.
std::vector<TransitionRange> training_stretches(const Recording& recording);

using RowMajorJacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Residuals measured - predicted of a model over stretches of runs. Each sample is predicted from the previous
/// measured sample. n rows per sample, in the state's unit. Samples that are not finite are skipped. Holds references
/// to model and runs, which must outlive it.
class ModelResiduals {
 public:
  /// `weights` are factors of each transition's square, in the order of the stretches; only minimise_model with least
  /// squares takes them. If `weights` is empty, all are 1. Samples of weight zero are skipped.
  ModelResiduals(const MotionModel& model, const std::vector<TransitionRange>& stretches,
                 const Eigen::VectorXd& weights = {});

  const MotionModel& model() const { return model_; }
  Index states() const { return model_.states(); }
  Index samples() const { return static_cast<Index>(transitions_.size()); }  ///< number of samples with a residual
  Index rows() const { return samples() * states(); }
  Index unknowns() const { return model_.parameter_count(); }
  double weight(Index sample) const { return weights_.size() > 0 ? weights_(sample) : 1.0; }

  /// Increments that the model should explain, one row per sample.
  Eigen::MatrixXd responses() const;

  /// Computes r (rows). If the second pointer is not null, also computes the derivatives of the predictions with
  /// respect to theta (rows x unknowns): dr = -J d(theta).
  void evaluate(const double* theta, Eigen::VectorXd& r, RowMajorJacobian* J) const;
  /// `evaluate` for samples first .. first + count - 1: count n numbers and, if the pointer is not null, count n rows
  /// of J.
  void evaluate(const double* theta, Index first, Index count, double* r, double* J) const;

 private:
  const MotionModel& model_;
  std::vector<MotionModel::Transition> transitions_;  ///< the finite transitions of the stretches
  Eigen::VectorXd weights_;                           ///< one weight per finite transition; empty without weights
};

}  // namespace modebank
