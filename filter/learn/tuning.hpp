#pragma once

#include <array>
#include <cstddef>

namespace modebank {

/// The constants of refinement, each with its reason. They are not keys. Those set by experiment were set inside
/// training runs (docs/explanation/refinement.md).
struct RefineTuning {
  // The cross-validation inside the training runs.
  /// Iterations after which left-out runs are scored; the iteration limit counts as one. Not before 10, because the
  /// start has used all training runs, and the fit needs some iterations to forget the left-out ones. Earlier
  /// checkpoints made results on ICE worse.
  std::array<std::ptrdiff_t, 7> checkpoints{10, 20, 35, 60, 100, 200, 1000};
  /// A start is dropped after this many checkpoints in a row at least least_gain below its best score. On ICE, FLOORING
  /// and DRIVE (training runs; 13, 13 and 10 starts) none recovered after two, but some did after one.
  int falls = 2;
  /// Candidate memories of the noise scale: 20, 50 and 200 samples, and the whole run.
  std::array<double, 4> forgettings{0.95, 0.98, 0.995, 1.0};
  /// Candidate weights of scale one at a run's start, in samples: from nearly none to most short runs' length.
  std::array<double, 4> noise_prior_samples{1.0, 2.0, 5.0, 20.0};
  std::ptrdiff_t fewest_whole_runs = 3;  ///< fewer runs are cut into stretches, because two folds would train on half
                                         ///< of the data
  std::ptrdiff_t shortest_stretch = 20;  ///< samples; shorter stretches would mostly be filter starts

  /// Largest loss of a bank with fewer modes against the best, in nats per sample; it must also be within one standard
  /// error. With few runs the standard error is unreliable, and a fifth of the usual gain of modes should not be
  /// missed.
  double most_loss = 0.02;

  // The rule on additions (left_out/rule.hpp).
  /// Probability that any proposal is accepted if there is nothing to be found.
  double taken_by_chance = 0.05;
  /// Number of proposals for one configuration: number of modes, prior, measurement noise, noise by input, transitions
  /// by state, drift, look-ahead.
  int proposals = 7;

  // The prior.
  double Q_transitions = 4.0;                            ///< weight of the prior on Q while starts are compared, in
                                                         ///< transitions
  std::array<double, 2> other_Q_transitions{1.0, 16.0};  ///< also tried for the best start: a factor of four either way
  double Q_transitions_unvalidated = 1.0;                ///< if nothing is left out to choose by: unit information
  double Q_transitions_with_R = 1.0;                     ///< of the modes' own harmonic mean, for unknown states
  /// Share of the largest information that is added in every direction of theta, so that unit information is definite.
  double least_information = 1e-8;

  // Expectation-maximisation and its starts.
  int alternations = 3;      ///< between theta and Q in one maximisation; each raises the objective, and after three
                             ///< little is left
  double start_stay = 0.95;  ///< diagonal of T of a start from stretches, as BankOptions::stay
  double modes_kept = 0.75;  ///< share of the modes kept in each smaller start from the mixture

  // Screening of fitted modes.
  double duplicate_significance = 0.95;  ///< of the likelihood-ratio test that separates two modes
  /// Tolerance above 1. The mean-square growth of double integrators is not known more accurately, and integrators must
  /// be kept.
  double growth_slack = 1e-4;
  std::ptrdiff_t iterations_after_screening =
      10;  ///< equal to the first checkpoint; the other modes adapt to the removal

  // Look-ahead learning.
  /// Weights of the prior towards one motion that are tried for the best start, in transitions.
  std::array<double, 5> theta_transitions{3.0, 30.0, 300.0, 3e3, 3e5};
  std::ptrdiff_t one_motion_iterations = 20;  ///< iterations with one theta, which give the target of shrinking
  double shrinkage_digits = 1e-3;             ///< accuracy of the share at which a shrunk bank is stable

  // Switching by state and input.
  double weight_width =
      30.0;  ///< prior sd of the weights in units of the regressors' standard deviation: a border a thirtieth wide
  std::array<double, 2> other_weight_widths{3.0, 300.0};  ///< tried for the chosen number of modes
  double little_memory_sd = 0.1;  ///< of log odds, tried with the chosen width: the previous mode hardly matters

  // Modes that drift: values tried, the middle ones first.
  std::array<double, 5> drift_rates{1e-5, 1e-4, 1e-3, 1e-2, 1e-1};       ///< variance added per step
  std::array<double, 6> drift_starts{0.0, 0.01, 0.1, 1.0, 10.0, 100.0};  ///< variance at a run's start
  std::array<double, 3> drift_leaks{1.0, 0.97, 0.9};                     ///< factor per step on the deviation
  /// With drifting coefficients the noise scale can use few samples (DART: 0.9; banks without drift: 0.98).
  std::array<double, 8> drift_forgettings{0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98, 1.0};
  std::array<double, 5> drift_noise_prior_samples{1e-3, 1e-2, 0.1, 1.0,
                                                  5.0};  ///< weight of scale one at a run's start, in samples

  // Measurement noise.
  double least_R_share = 1e-9;  ///< of the global residual variance: the smallest R in refinement, negligible
  /// Starts of the searches for R, as shares of the mean Q. Below a half, because R counts twice in Q. From 5 % alone,
  /// an R of 1 % of Q or of many times Q could be missed.
  std::array<double, 4> R_start_shares{0.05, 0.005, 0.2, 0.45};
  /// Start of the search for R together with theta. It is used if R = 0 is most likely with the theta of exact states.
  double R_start_share_with_theta = 0.2;
  /// Nats per sample; smaller gains do not hold on other runs (seeds change held-out scores by 0.03 to 0.07).
  double least_gain = 1e-3;
};

inline constexpr RefineTuning refine_tuning{};  ///< the values in use

}  // namespace modebank
