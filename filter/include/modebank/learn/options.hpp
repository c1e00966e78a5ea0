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

/// Source of T. labels: transitions between labels of neighbouring windows. stay: BankOptions::stay. logit: as labels,
/// but T of a refined bank depends on state and input, if this raises the score of training runs that were left out.
enum class TransitionSource { labels, stay, logit };

template <>
struct EnumNames<TransitionSource> {
  static constexpr Names<3> values{"labels", "stay", "logit"};
};

/// Refinement after the mixture: none, or expectation-maximisation of the switching model. automatic: em, unless it is
/// impossible (for the modes of a motion model) or would undo another option: a theta, Q or T that is given or taken
/// from the mixture (ThetaSource::mean, process_variance, TransitionSource::stay).
enum class Refine { automatic, none, em };

template <>
struct EnumNames<Refine> {
  static constexpr Names<3> values{"auto", "none", "em"};
};

/// Options of a bank's refinement.
struct RefineOptions {
  std::ptrdiff_t max_iterations = 100;  ///< iteration limit of expectation-maximisation
  double tolerance = 1e-6;              ///< stopping tolerance: smallest gain of the objective [nats per transition]
  std::ptrdiff_t restarts = 2;          ///< random starts from stretches of the runs, for each number of modes
  std::ptrdiff_t most_modes = 0;        ///< largest number of modes of the random starts; then three quarters of it and
                                        ///< so on, down to the mixture's number. With 0, the mixture's number alone
  std::ptrdiff_t folds = 6;  ///< parts of the cross-validation; 1 turns it off, and every start runs to convergence
  bool measurement_noise = true;  ///< whether R maximises the filter's likelihood; false: R of the start is kept
  bool screen = true;             ///< whether unstable, starved and duplicate modes are removed
  bool state_dependent_transition = false;  ///< whether T may depend on state and input (TransitionSource::logit)
  std::uint64_t seed = 1;                   ///< of the random starts
  std::ptrdiff_t transitions = 20000;       ///< most transitions to learn from, in stretches drawn by the seed; 0: all
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
  FilterOptions filter;           ///< filter of the bank; with variant `kf`, the bank is the baseline
  std::uint64_t seed = 1;         ///< the only seed; it replaces the seeds in `window` and `bank`
  bool search_lags = false;       ///< whether cross-validation chooses lags and delay; not for motion models
  bool automatic_length = false;  ///< whether window.length is set from the number of regressors
  bool automatic_step = false;    ///< whether window.step is set so that there are about 100,000 windows
};

}  // namespace modebank
