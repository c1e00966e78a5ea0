#pragma once

#include <string>
#include <vector>

#include "ident/check/stream_check.hpp"
#include "ident/lag/choice.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// An input counts as zero, or still, within this share of its largest value.
inline constexpr double still_share = 0.005;

/// Samples of `states` at rest: every input in force there is within `still_level` (per input, m) of zero, and so it
/// was a sample before, and every state repeats its value. None without inputs: nothing then separates rest from a
/// measurement that is too coarse.
std::vector<bool> resting_samples(const Stream& states, const Stream& inputs, const Eigen::VectorXd& still_level);

/// Samples of `inputs` at which all inputs are within `still_level` of zero, as they were a sample before.
std::vector<bool> still_samples(const Stream& inputs, const Eigen::VectorXd& still_level);

/// Share of known samples equal to the one before, among those that `at_rest` leaves; 0 where it leaves none.
double repeats_in_motion(const Eigen::VectorXd& values, const std::vector<bool>& at_rest);

/// Commands of one run: stillness and constancy.
struct CommandCheck {
  double still = 0.0;               ///< share of input samples with every input within `still_level` of zero
  double longest_constant_s = 0.0;  ///< longest time in which no input changes while one is not still
  double changes = 0.0;             ///< share of input samples that differ from the one before
};
/// `still_level`: per input (m).
CommandCheck check_commands(const Stream& inputs, const Eigen::VectorXd& still_level);

/// Mean and standard deviation of each state while all inputs have been still for settle_s, over rests of at least
/// 1 s; NaN where there is none.
struct RestCheck {
  double duration_s = 0.0;
  Eigen::VectorXd mean, sd;  ///< n
};
RestCheck check_rest(const Stream& states, const Stream& inputs, const Eigen::VectorXd& still_level);

/// Order of persistent excitation (Ljung 1999, def. 13.2): largest d <= most for which the inputs and their first d - 1
/// delays, each in units of its root mean square, have a second-moment matrix with no eigenvalue below 1e-4.
inline constexpr Eigen::Index most_excitation_order = 10;
Eigen::Index excitation_order(const Eigen::MatrixXd& inputs, Eigen::Index most = most_excitation_order);

/// Share of windows of `length` transitions whose regressors are rank deficient, of at most `most_windows` evenly
/// spread ones; NaN for none.
struct DeficientWindows {
  Eigen::Index windows = 0, deficient = 0;
  double share() const;
};
DeficientWindows count_deficient_windows(const Trajectory& run, Eigen::Index length, const LinearStructure& structure,
                                         Eigen::Index most_windows = 1000);

}  // namespace modebank
