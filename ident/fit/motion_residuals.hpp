#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"
#include "ident/model/motion_model.hpp"

namespace modebank {

/// Consecutive transitions of one run.
struct Stretch {
  const Trajectory* run = nullptr;
  Index start = 0;
  Index length = 0;
};

/// All transitions of the training runs.
std::vector<Stretch> training_stretches(const Recording& recording);

using RowMajorJacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Residuals measured - predicted of a model over stretches of runs, n rows per sample, in the state's unit. Samples
/// that are not finite have no residual. The unknowns are theta and, for simulations, the first state of each stretch
/// after it. Refers to model and runs, which must outlive it.
class ModelResiduals {
 public:
  /// `weights`: what multiplies the loss of each transition of the stretches, in their order (one-step residuals
  /// only); empty: the runs' sample weights, divided by their mean, or one for all. Samples of weight zero have no
  /// residual.
  ModelResiduals(const MotionModel& model, const std::vector<Stretch>& stretches, ResidualKind kind,
                 const Eigen::VectorXd& weights = {});

  const MotionModel& model() const { return model_; }
  Index states() const { return model_.states(); }
  Index samples() const { return samples_; }  ///< with a residual
  Index rows() const { return samples_ * states(); }
  Index unknowns() const { return model_.parameter_count() + initial_states_.size(); }
  double weight(Index sample) const { return weights_.size() > 0 ? weights_(sample) : 1.0; }
  const Eigen::VectorXd& weights() const { return weights_; }  ///< empty: all one
  /// What the model explains, one row per sample times the root of its weight: increments, or for simulations states.
  Eigen::MatrixXd responses() const;
  /// theta followed by the measured first states.
  Eigen::VectorXd unknowns_at(const Eigen::VectorXd& theta) const;

  /// r (rows) and, if not null, the predictions' derivatives by the unknowns (rows x unknowns): dr = -J d(unknowns).
  void evaluate(const double* unknowns, Eigen::VectorXd& r, RowMajorJacobian* J) const;

 private:
  void take_transitions(const std::vector<Stretch>& stretches, const Eigen::VectorXd& weights);
  void take_simulations(const std::vector<Stretch>& stretches);
  void take_run_weights(const std::vector<double>& weights);
  void one_step(const double* theta, Eigen::VectorXd& r, RowMajorJacobian* J) const;
  void simulate(const double* unknowns, Eigen::VectorXd& r, RowMajorJacobian* J) const;

  const MotionModel& model_;
  ResidualKind kind_;
  std::vector<Stretch> stretches_;
  std::vector<MotionModel::Transition> transitions_;  ///< one-step: those that are finite
  Eigen::VectorXd weights_;                           ///< of those; empty without
  Eigen::VectorXd initial_states_;                    ///< simulation: as measured
  Index samples_ = 0;
};

}  // namespace modebank
