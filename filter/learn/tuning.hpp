#pragma once

#include <array>
#include <cstddef>

namespace modebank {

/// The numbers that decide what refinement learns, each with its reason. They are not keys: where an experiment set
/// one it was made inside the training runs (docs/explanation/refinement.md).
struct RefineTuning {
  // The cross-validation inside the training runs.
  /// Iterations after which the runs left out are scored; the limit counts as one. Not before 10: the start has seen
  /// all training runs, and it takes the fit to the others a while to forget that. A first version without that rule
  /// did worse on ice.
  std::array<std::ptrdiff_t, 7> checkpoints{10, 20, 35, 60, 100, 200, 1000};
  /// Checkpoints in a row that score least_gain below a start's best, after which it goes on no further: on ICE,
  /// FLOORING and DRIVE no start (of 13, 13 and 10; training runs) got better again after two, some did after one.
  int falls = 2;
  /// Memories of the noise scale that are tried: 20, 50 and 200 samples, and all of the run.
  std::array<double, 4> forgettings{0.95, 0.98, 0.995, 1.0};
  /// Samples that a run's start at scale one is worth: from hardly any to those of most short runs.
  std::array<double, 4> noise_prior_samples{1.0, 2.0, 5.0, 20.0};
  std::ptrdiff_t fewest_whole_runs = 3;  ///< fewer are cut into stretches: two folds would train on half of the data
  std::ptrdiff_t shortest_stretch = 20;  ///< samples; shorter ones would mostly be starts

  /// Nats per sample that a bank with fewer modes may lose to the best, beside being within one standard error of it:
  /// few runs know their differences badly, and a fifth of what modes are typically worth should not go unseen.
  double most_loss = 0.02;

  // The rule on additions (left_out/rule.hpp).
  /// The probability of it, of all proposals together, where there is nothing to be found.
  double taken_by_chance = 0.05;
  /// That one configuration may ask about: number of modes, prior, measurement noise, noise by input, transitions by
  /// state, drift, look-ahead.
  int proposals = 7;

  // The prior.
  double Q_transitions = 4.0;                            ///< that the prior on Q is worth while starts are compared
  std::array<double, 2> other_Q_transitions{1.0, 16.0};  ///< tried for the best start: a factor of four either way
  double Q_transitions_unvalidated = 1.0;                ///< where nothing is left out to choose by: unit information
  double Q_transitions_with_R = 1.0;  ///< of the modes' own harmonic mean, once the states count as unknown
  /// Share of the largest information that every direction of theta gets, so that unit information is definite.
  double least_information = 1e-8;

  // Expectation-maximisation and its starts.
  int alternations = 3;      ///< of theta and Q in one maximisation; each raises the objective, three leave little
  double start_stay = 0.95;  ///< diagonal of T of a start from stretches, as BankOptions::stay
  double modes_kept = 0.75;  ///< share of the modes that each next smaller start of the mixture keeps

  // Screening of fitted modes.
  double duplicate_significance = 0.95;  ///< of the likelihood-ratio test that tells two modes apart
  /// Above 1: mean-square growth of systems that integrate twice is known to no more digits, and an integrator stays.
  double growth_slack = 1e-4;
  std::ptrdiff_t iterations_after_screening =
      10;  ///< as many as the first checkpoint: the others take over what is left

  // Learning that looks ahead.
  /// Transitions at one motion that every mode's theta is as if it had seen besides its own, tried for the best start.
  std::array<double, 5> theta_transitions{3.0, 30.0, 300.0, 3e3, 3e5};
  std::ptrdiff_t one_motion_iterations = 20;  ///< of expectation-maximisation with one theta, to know what is drawn to
  double shrinkage_digits = 1e-3;             ///< of the share of the way to one motion at which a bank is stable

  // Switching by state and input.
  double weight_width =
      30.0;  ///< prior sd of its weights in units of the regressors' spread: a border a thirtieth wide
  std::array<double, 2> other_weight_widths{3.0, 300.0};  ///< tried for the chosen number of modes
  double little_memory_sd = 0.1;  ///< of log odds, tried with the chosen width: the mode before hardly matters

  // Modes that drift: values tried, the middle ones first.
  std::array<double, 5> drift_rates{1e-5, 1e-4, 1e-3, 1e-2, 1e-1};       ///< variance that a step adds
  std::array<double, 6> drift_starts{0.0, 0.01, 0.1, 1.0, 10.0, 100.0};  ///< variance at a start
  std::array<double, 3> drift_leaks{1.0, 0.97, 0.9};                     ///< what a step leaves
  /// Coefficients that follow a run let the noise scale be of few samples (DART: 0.9; banks that do not drift 0.98).
  std::array<double, 8> drift_forgettings{0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98, 1.0};
  std::array<double, 5> drift_noise_prior_samples{1e-3, 1e-2, 0.1, 1.0, 5.0};  ///< that a run's start is worth

  // Measurement noise.
  double least_R_share = 1e-9;  ///< of the global residual variance: the least R that refinement knows, as good as none
  /// Of the mean Q, where the searches for R start; below a half, because R counts twice in what Q held. From 5 % alone
  /// an R of a per cent of Q, or of many times Q, could be missed.
  std::array<double, 4> R_start_shares{0.05, 0.005, 0.2, 0.45};
  /// The same where theta is searched, too, because with the theta of exact states no R was likelier than none.
  double R_start_share_with_theta = 0.2;
  /// Nats per sample: less would not survive on other runs (seeds move held-out scores by 0.03 to 0.07).
  double least_gain = 1e-3;
};

inline constexpr RefineTuning refine_tuning{};  ///< what refinement goes by

}  // namespace modebank
