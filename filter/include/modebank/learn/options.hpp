#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "modebank/base/names.hpp"
#include "modebank/filter/options.hpp"
#include "modebank/ident/options.hpp"
#include "modebank/mixture/options.hpp"

namespace modebank {

/// Where a mode's parameters come from: weighted least squares over its transitions, or its component's mean.
enum class ThetaSource { pooled, mean };

template <>
struct EnumNames<ThetaSource> {
  static constexpr Names<2> values{"pooled", "mean"};
};

/// Where the modes' process noise Q comes from: each mode's own residuals, all modes' together, or a given variance.
enum class NoiseSource { per_mode, shared, fixed };

template <>
struct EnumNames<NoiseSource> {
  static constexpr Names<3> values{"per-mode", "shared", "fixed"};
};

/// Where the transition matrix comes from: how labels of neighbouring windows follow each other, or BankOptions::stay;
/// logit: as labels, and in a refined bank a function of state and input where training runs left out gain by it.
enum class TransitionSource { labels, stay, logit };

template <>
struct EnumNames<TransitionSource> {
  static constexpr Names<3> values{"labels", "stay", "logit"};
};

/// What follows the bank of the mixture: nothing, or expectation-maximisation of the switching model. automatic: that,
/// but nothing where it cannot be or would undo what was asked for: the modes of a motion model, and a theta, Q or T
/// that are to be the mixture's or given ones (ThetaSource::mean, NoiseSource::shared or fixed,
/// TransitionSource::stay).
enum class Refine { automatic, none, em };

template <>
struct EnumNames<Refine> {
  static constexpr Names<3> values{"auto", "none", "em"};
};

/// Whether modes keep learning within a run, each its own theta: not at all; or as fast as training runs left out gain
/// most by, and not where they gain nothing. Only in a refined bank whose states are measured exactly.
enum class Drift { none, automatic };

template <>
struct EnumNames<Drift> {
  static constexpr Names<2> values{"none", "auto"};
};

/// What learning that looks ahead counts of a prediction: its log density, or its squared error.
enum class LookAheadScore { density, error };

template <>
struct EnumNames<LookAheadScore> {
  static constexpr Names<2> values{"density", "error"};
};

/// How a bank is refined. Defaults are the recommended method.
struct RefineOptions {
  std::ptrdiff_t max_iterations = 100;  ///< of expectation-maximisation
  double tolerance = 1e-6;              ///< nats per transition: stop when the objective gains less
  std::ptrdiff_t restarts = 2;          ///< starts from random stretches of the runs besides the mixture's, for each
                                        ///< number of modes tried
  std::ptrdiff_t most_modes = 0;        ///< stretches start with so many modes, three quarters, ... down to the
                                        ///< mixture's number, which is a start and no finding; 0: with that one alone
  std::ptrdiff_t look_ahead = 1;        ///< samples: fits are judged by predictions 1 to so many samples ahead
  LookAheadScore look_ahead_score = LookAheadScore::density;  ///< density: of starts, modes and iterations, too
  std::ptrdiff_t folds = 6;       ///< parts of the cross-validation; 1: none, every start runs to convergence
  bool measurement_noise = true;  ///< R by maximum likelihood of the filter on the training runs; false: the start's R
  bool screen = true;             ///< take unstable, starved and duplicate modes out
  bool guards = false;            ///< switches may see state and input (TransitionSource::logit)
  bool one_theta = false;         ///< all modes have the same theta and differ in Q: the rival that knows one motion
  bool noise_by_input = false;  ///< every Q times one factor that follows state and input; R then stays as good as none
  std::uint64_t seed = 1;       ///< of the random starts
  Drift drift = Drift::none;    ///< whether theta of each mode follows a run
  std::ptrdiff_t transitions = 20000;  ///< learn from so many at most, stretches of the runs drawn with the seed; 0:
                                       ///< from all

  /// How far ahead densities decide.
  std::ptrdiff_t densities_ahead() const { return look_ahead_score == LookAheadScore::density ? look_ahead : 1; }
};

/// How a mixture of windows becomes a bank. Defaults are the recommended method.
struct BankOptions {
  ThetaSource theta = ThetaSource::pooled;                 ///< of a mode's parameters
  NoiseSource noise = NoiseSource::per_mode;               ///< of Q
  TransitionSource transition = TransitionSource::labels;  ///< of the transition matrix
  double stay = 0.95;                          ///< diagonal of the transition matrix for TransitionSource::stay
  double process_variance = 0.01;              ///< Q diagonal for NoiseSource::fixed [state unit^2]
  std::optional<double> measurement_variance;  ///< R diagonal [state unit^2]; empty: the baseline's R
  bool screen = true;                          ///< leave unstable and starved modes out
  std::ptrdiff_t modes = 0;                    ///< at most so many: the closest components are merged; 0: no limit
  Refine refine = Refine::automatic;           ///< whether expectation-maximisation goes on from the mixture's bank
  RefineOptions em;                            ///< how, then
};

/// All that decides what is learned from runs. `modebank run` finds lags, delay and windows from the data unless it is
/// told otherwise: search_lags, automatic_length and automatic_step say so here.
struct LearnOptions {
  FitOptions window;              ///< how windows are cut and fitted
  ClusterOptions mixture;         ///< how they are clustered
  BankOptions bank;               ///< how their mixture becomes a bank
  FilterOptions filter;           ///< that will run the bank; variant kf asks for a single Kalman filter: the baseline
  std::uint64_t seed = 1;         ///< the one seed: takes the place of those in `window` and `bank`
  bool search_lags = false;       ///< lags and delay are those that training runs left out prefer, whatever `window`
                                  ///< has; not of motion models
  bool automatic_length = false;  ///< window.length follows the number of regressors
  bool automatic_step = false;    ///< window.step leaves 100,000 windows
  bool noise_by_input = true;     ///< all process noise has one factor that follows states and inputs, where training
                                  ///< runs left out gain by it
};

}  // namespace modebank
