#pragma once

#include <Eigen/Core>
#include <optional>

#include "filter/judge/evaluate.hpp"
#include "filter/learn/refine/refine.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"
#include "mixture/select.hpp"

namespace modebank {

enum class ThetaSource { pooled, mean };
enum class NoiseSource { per_mode, shared, fixed };
enum class TransitionSource { labels, stay };
enum class Refine { none, em };

template <>
struct EnumNames<ThetaSource> {
  static constexpr Names<2> values{"pooled", "mean"};
};

template <>
struct EnumNames<NoiseSource> {
  static constexpr Names<3> values{"per-mode", "shared", "fixed"};
};

template <>
struct EnumNames<TransitionSource> {
  static constexpr Names<2> values{"labels", "stay"};
};

template <>
struct EnumNames<Refine> {
  static constexpr Names<2> values{"none", "em"};
};

struct BankOptions {
  ThetaSource theta = ThetaSource::pooled;
  NoiseSource noise = NoiseSource::per_mode;
  TransitionSource transition = TransitionSource::labels;
  double stay = 0.95;                          ///< diagonal of the transition matrix for TransitionSource::stay
  double process_variance = 0.01;              ///< Q diagonal for NoiseSource::fixed [state unit^2]
  std::optional<double> measurement_variance;  ///< R diagonal [state unit^2]; empty: the baseline's R
  bool screen = true;                          ///< leave unstable and starved modes out
  Index modes = 0;                             ///< at most so many: the closest components are merged; 0: no limit
  Refine refine = Refine::none;                ///< em: refine_bank takes over from the mixture's bank
  RefineOptions em;
};

/// One Kalman filter on the global model, Q and R by maximum likelihood, and how that ended.
struct Baseline {
  Bank bank;                    ///< K = 1
  double log_likelihood = 0.0;  ///< of the training runs, from each run's second sample
  bool converged = false;
  bool at_bound = false;  ///< R stopped at its lower bound 1e-10 var(y): the data show no measurement noise
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

/// learn_bank, then refine_bank from it and from what is left of the mixture when its closest components are merged
/// (merge_components) down to three quarters of the modes, again and again until there is one: where more modes do not
/// pay on training runs left out, as with little data, one mode wins. The mixture's own bank is `start` of the result.
Refinement learn_refined_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                              const BankOptions& options, const Eigen::MatrixXd& R, const FilterOptions& filter);

}  // namespace modebank
