#pragma once

#include <Eigen/Core>
#include <optional>

#include "filter/judge/evaluate.hpp"
#include "filter/learn/refine/refine.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"
#include "mixture/select.hpp"
#include "modebank/learn/options.hpp"

namespace modebank {

/// One Kalman filter on the global model, Q and R by maximum likelihood, and how that ended.
struct Baseline {
  Bank bank;                    ///< K = 1
  double log_likelihood = 0.0;  ///< of the training runs, from each run's second sample
  bool converged = false;
  bool at_bound = false;  ///< R stopped where it adds 1e-8 to the residual variance: the data show no measurement noise
};

/// theta fixed at the global least squares; Q (full) and R (diagonal) maximise the exact Gaussian likelihood.
Baseline learn_baseline(const Recording& recording, const GlobalModel& global, const LinearStructure& structure);

/// The competitor that switches noise only: one Huber theta, eight log-spaced noise scales, `stay` chosen on the
/// training runs.
Bank learn_noise_only(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R);

/// Turns clustered windows into a bank (method: section 4). `R` is used unless options.measurement_variance is set.
/// `motion`: the model that the windows were fitted with, null for linear ones; its modes are linearised at their mean
/// state and input. Where every component is screened the bank has one mode, of all of them merged; throws DataError
/// when that one is screened too.
Bank learn_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                const BankOptions& options, const Eigen::MatrixXd& R, const MotionModel* motion = nullptr);

/// Refine::automatic as em or none (Refine says when), other values as they are. `linear`: not a motion model's
/// windows.
Refine refinement_asked(const BankOptions& options, bool linear);

/// learn_refined_bank or learn_bank alone, as refinement_asked says; only the first needs `filter`. It knows no motion
/// models: throws std::invalid_argument where it is asked for with one.
Refinement learn_as_asked(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                          const BankOptions& options, const Eigen::MatrixXd& R,
                          const std::optional<FilterOptions>& filter, const MotionModel* motion);

/// learn_bank, then refine_bank from it and from what is left of the mixture when its closest components are merged
/// (merge_components) down to three quarters of the modes, again and again until there is one: where more modes do not
/// pay on training runs left out, as with little data, one mode wins. The mixture's own bank is `start` of the result.
Refinement learn_refined_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                              const BankOptions& options, const Eigen::MatrixXd& R, const FilterOptions& filter);

}  // namespace modebank
