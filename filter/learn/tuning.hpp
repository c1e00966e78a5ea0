#pragma once

#include <array>
#include <cstddef>

namespace modebank {

/// The constants of refinement, with reasons. They cannot be configured. Constants that come from experiments were set
/// inside training runs (docs/explanation/refinement.md).
struct RefineTuning {
  // The cross-validation inside the training runs.

  /// Left-out runs are scored after these numbers of iterations, and at the iteration limit. The first is 10. The start
  /// has used all training runs, so a fit needs some iterations to forget the left-out runs. Earlier checkpoints made
  /// results on ICE worse.
  std::array<std::ptrdiff_t, 7> checkpoints{10, 20, 35, 60, 100, 200, 1000};
  /// A start is dropped if its score is at least least_gain below its best score for this number of checkpoints in a
  /// row. On ICE, FLOORING and DRIVE (training runs; 13, 13 and 10 starts) no start recovered after two checkpoints,
  /// but some recovered after one.
  int falls = 2;
  std::ptrdiff_t fewest_whole_runs = 3;  ///< with fewer runs, runs are cut into stretches, because two folds would
                                         ///< train on half of the data
  std::ptrdiff_t shortest_stretch = 20;  ///< samples; in shorter stretches the filter would mostly be starting

  /// Largest loss of a bank with fewer modes against the best, in nats per sample. The loss must also be within one
  /// standard error. With few runs the standard error is unreliable. Modes with a fifth of the usual gain should still
  /// not be missed, so this limit is needed.
  double most_loss = 0.02;

  // The rule for additions (left_out/rule.hpp).

  /// Probability that any proposal is accepted if the model needs no addition.
  double taken_by_chance = 0.05;
  /// Number of proposals for one configuration. The proposals are: number of modes, prior, measurement noise, noise by
  /// input, transitions by state, a fit over a horizon.
  int proposals = 7;

  // The prior.
  double Q_transitions = 4.0;                            ///< weight of the prior on Q while starts are compared, in
                                                         ///< transitions
  std::array<double, 2> other_Q_transitions{1.0, 16.0};  ///< also tried for the best start: a quarter of the value
                                                         ///< above, and four times that value
  double Q_transitions_unvalidated = 1.0;                ///< used if no run can be left out; one transition is unit
                                                         ///< information
  double Q_transitions_with_R = 1.0;  ///< number of additional transitions with the harmonic mean of the modes' Q, for
                                      ///< unknown states

  /// Share of the largest information that is added in every direction of theta, so that the information of one
  /// transition is definite.
  double least_information = 1e-8;

  // Expectation-maximisation and its starts.
  int alternations = 3;  ///< alternations between theta and Q in one maximisation. Each raises the objective; more than
                         ///< three gain little
  double start_stay = 0.95;  ///< diagonal of T of a start from stretches, equal to BankOptions::stay
  double modes_kept = 0.75;  ///< number of modes of a smaller start from the mixture, as a share of the next larger one

  // Screening of fitted modes.
  double duplicate_significance = 0.95;  ///< level of the likelihood-ratio test that separates two modes

  /// Tolerance for a mean-square growth above 1. The growth of double integrators cannot be computed more accurately,
  /// and integrators must be kept.
  double growth_slack = 1e-4;
  std::ptrdiff_t iterations_after_screening =
      10;  ///< number of iterations after a removal, in which the other modes adapt; equal to the first checkpoint

  // Measurement noise.
  double least_R_share = 1e-9;  ///< smallest R in refinement, as a share of the global residual variance; it is
                                ///< negligible
  /// Nats per sample. Smaller gains do not hold on other runs. (Other seeds change held-out scores by 0.03 to 0.07.)
  double least_gain = 1e-3;
};

inline constexpr RefineTuning refine_tuning{};  ///< the constants that are used

}  // namespace modebank
