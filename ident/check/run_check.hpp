#pragma once

#include <string>
#include <vector>

#include "ident/check/stream_check.hpp"
#include "ident/lag/choice.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// An input counts as zero (still) up to this share of its largest value.
inline constexpr double still_share = 0.005;

/// Flags the samples of `states` at rest. A sample is at rest if two conditions hold. All inputs are within
/// `still_level` (m, one per input) of zero, at the sample and one sample earlier. Every state repeats its previous
/// value. Without inputs no sample is flagged, because a coarse measurement would also repeat its values.
std::vector<bool> resting_samples(const Stream& states, const Stream& inputs, const Eigen::VectorXd& still_level);

/// Flags the samples of `inputs` at which all inputs are within `still_level` of zero, both at the sample and one
/// sample earlier.
std::vector<bool> still_samples(const Stream& inputs, const Eigen::VectorXd& still_level);

/// Share of known samples that equal the previous sample. Samples flagged in `at_rest` are ignored; 0 if no samples
/// remain.
double repeats_in_motion(const Eigen::VectorXd& values, const std::vector<bool>& at_rest);

/// Figures of the inputs of one run: the share of still samples, and how often values change.
struct CommandCheck {
  double still = 0.0;               ///< share of input samples with every input within `still_level` of zero
  double longest_constant_s = 0.0;  ///< longest time without a change of any input while at least one input is not
                                    ///< still
  double changes = 0.0;             ///< share of input samples that differ from the previous one
};
/// Checks the inputs of one run. `still_level` has one entry per input (m).
CommandCheck check_commands(const Stream& inputs, const Eigen::VectorXd& still_level);

/// Mean and standard deviation of each state at rest. A rest lasts at least 1 s and begins after all inputs have been
/// still for settle_s. NaN if the run has no rest.
struct RestCheck {
  double duration_s = 0.0;
  Eigen::VectorXd mean, sd;  ///< n
};
RestCheck check_rest(const Stream& states, const Stream& inputs, const Eigen::VectorXd& still_level);

/// Order of persistent excitation (Ljung 1999, def. 13.2). Consider the second-moment matrix of the inputs and their
/// first d - 1 delays. The order is the largest d, up to `most`, for which all eigenvalues of this matrix are above
/// 1e-4. Each input is divided by its root mean square.
inline constexpr Eigen::Index most_excitation_order = 10;
Eigen::Index excitation_order(const Eigen::MatrixXd& inputs, Eigen::Index most = most_excitation_order);

/// Share of the windows of `length` transitions whose regressors are rank deficient. At most `most_windows` evenly
/// spread windows are examined. NaN without windows.
struct DeficientWindows {
  Eigen::Index windows = 0, deficient = 0;
  double share() const;
};
DeficientWindows count_deficient_windows(const Trajectory& run, Eigen::Index length, const LinearStructure& structure,
                                         Eigen::Index most_windows = 1000);

}  // namespace modebank
