#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "modebank/base/names.hpp"
#include "modebank/filter/options.hpp"
#include "modebank/ident/options.hpp"
#include "modebank/mixture/options.hpp"

namespace modebank {

/// Source of a mode's parameters: weighted least squares over its transitions, or its component's mean.
enum class ThetaSource { pooled, mean };

template <>
struct EnumNames<ThetaSource> {
  static constexpr Names<2> values{"pooled", "mean"};
};

/// Source of the transition matrix. labels: transitions between labels of neighbouring windows. stay:
/// BankOptions::stay. logit: like labels; in a refined bank the transition probabilities also depend on state and
/// input, if this raises the score of training runs that were left out.
enum class TransitionSource { labels, stay, logit };

template <>
struct EnumNames<TransitionSource> {
  static constexpr Names<3> values{"labels", "stay", "logit"};
};

/// Refinement after the mixture: none, or expectation-maximisation of the switching model. automatic: em, unless it is
/// impossible or would undo another option. em is impossible for the modes of a motion model. It would undo a theta, Q
/// or T that is given or taken from the mixture (ThetaSource::mean, process_variance,
/// TransitionSource::stay).
enum class Refine { automatic, none, em };

template <>
struct EnumNames<Refine> {
  static constexpr Names<3> values{"auto", "none", "em"};
};

/// Options of a bank's refinement. Defaults are the recommended method.
struct RefineOptions {
  std::ptrdiff_t max_iterations = 100;  ///< iteration limit of expectation-maximisation
  double tolerance = 1e-6;              ///< stopping tolerance: smallest gain of the objective [nats per transition]
  std::ptrdiff_t restarts = 2;    ///< number of random starts from stretches of the runs, for each number of modes; the
                                  ///< mixture's start is tried in addition
  std::ptrdiff_t most_modes = 0;  ///< largest number of modes of the random starts. The search tries this number, three
                                  ///< quarters of it and so on, down to the mixture's number. With 0, it tries only the
                                  ///< mixture's number
  std::ptrdiff_t folds = 6;       ///< number of parts of the cross-validation; 1 turns it off, and every start runs to
                                  ///< convergence
  bool measurement_noise = true;  ///< true: R maximises the filter's likelihood of the training runs; false: R of the
                                  ///< start is kept
  bool screen = true;             ///< whether unstable, starved and duplicate modes are removed
  bool state_dependent_transition = false;  ///< whether transition probabilities may depend on state and input
                                            ///< (TransitionSource::logit)
  bool one_theta = false;                   ///< whether all modes share theta and differ only in Q (the competitor with
                                            ///< one motion)
  bool noise_by_input = false;         ///< whether all Q share one factor that follows state and input; R then stays
                                       ///< negligible
  std::uint64_t seed = 1;              ///< seed of the random starts
  std::ptrdiff_t transitions = 20000;  ///< largest number of transitions to learn from; they lie in stretches drawn
                                       ///< with the seed; 0 takes all transitions
};

/// How a mixture of windows becomes a bank. Defaults are the recommended method.
struct BankOptions {
  ThetaSource theta = ThetaSource::pooled;                 ///< source of a mode's parameters
  TransitionSource transition = TransitionSource::labels;  ///< source of the transition matrix
  double stay = 0.95;                          ///< diagonal of the transition matrix for TransitionSource::stay
  std::optional<double> process_variance;      ///< Q diagonal [state unit^2]; if empty, each mode learns its own Q
  std::optional<double> measurement_variance;  ///< R diagonal [state unit^2]; if empty, R of the baseline is used
  bool screen = true;                          ///< whether unstable and starved modes are removed
  Refine refine = Refine::automatic;           ///< whether the bank is refined by expectation-maximisation
  RefineOptions em;                            ///< options of the refinement
};

/// All options of learning from runs. `modebank run` finds lags, delay and windows from the data unless they are given.
/// Here search_lags, automatic_length and automatic_step request this search.
struct LearnOptions {
  FitOptions window;              ///< how windows are cut and fitted
  ClusterOptions mixture;         ///< how windows are clustered
  BankOptions bank;               ///< how the mixture becomes a bank
  FilterOptions filter;           ///< filter of the bank; with variant `kf`, the bank is the baseline (a single Kalman
                                  ///< filter)
  std::uint64_t seed = 1;         ///< the only seed; it replaces the seeds in `window` and `bank`
  bool search_lags = false;       ///< whether lags and delay are chosen by cross-validation on training runs. They then
                                  ///< replace those in `window`. Not for motion models
  bool automatic_length = false;  ///< whether window.length is set from the number of regressors
  bool automatic_step = false;    ///< whether window.step is set so that there are about 100,000 windows
};

}  // namespace modebank
