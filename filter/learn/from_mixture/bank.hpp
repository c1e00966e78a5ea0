#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "filter/learn/refine/refine.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"
#include "ident/model/motion_model.hpp"
#include "mixture/select.hpp"
#include "modebank/learn/options.hpp"

namespace modebank {

/// A bank without modes: structure, measurement, names and sample period of the training data. C = [I 0] selects the
/// newest sample of z; the quanta are those of the recording; R is given, and at least the variance of rounding. A
/// lagged state is called "wz[k-1]". Throws std::invalid_argument unless R has one row per measured state and the
/// structure has the states and inputs of the recording.
Bank bank_frame(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R);

/// The stated R, if options.measurement_variance is set; otherwise `R`.
Eigen::MatrixXd stated_or(const BankOptions& options, const Eigen::MatrixXd& R);

/// Names of a bank's states and inputs, from the recording's columns.
std::vector<std::string> state_names(const Recording& recording, const LinearStructure& structure);
std::vector<std::string> input_names(const Recording& recording, const LinearStructure& structure);

/// The mode with theta and process noise `Q` of the measured states; lagged samples have no noise.
Mode make_mode(const LinearStructure& structure, const Eigen::VectorXd& theta, const Eigen::MatrixXd& Q,
               const Eigen::MatrixXd& parameter_covariance, const Eigen::VectorXd& standard_error, double weight);

/// Removes the standard errors of parameters that the training runs do not determine. The covariance of the global
/// model has missing values for these parameters. A prior does not change this.
void clear_unidentifiable(Bank& bank, const Eigen::MatrixXd& global_covariance);

/// Sets the transition matrix, with uniform initial probabilities.
void set_mode_sequence(Bank& bank, const TransitionMatrix& transition);

/// Added to every count of label transitions, so that no transition is impossible.
inline constexpr double label_count_smoothing = 0.1;

/// K x K counts of (label i, then label j) over neighbouring windows: same run, starts one `step` apart. `kept` lists
/// the mixture components that are modes (mode j is component kept[j]). Labels: M values, -1 for none. A window without
/// a mode, such as one that contains a switch, counts as the previous mode. So the switch is counted once, after that
/// window.
Eigen::MatrixXd count_label_transitions(const WindowFits& fits, const Eigen::VectorXi& labels,
                                        const std::vector<Index>& kept);

/// Normalises smoothed counts by rows and converts from one window step (`step` transitions) to one transition. The
/// diagonal becomes T_ii^(1/step); the rest of the row is scaled so that the row sums to one.
TransitionMatrix transition_from_counts(const Eigen::MatrixXd& counts, Index step);

/// Converts clustered windows into a bank (method: section 4). `R` is used unless options.measurement_variance is set.
/// `motion`: motion model of the windows, null for linear models. Its modes are linearised at their mean state and
/// input. If every component is screened out, the bank has one mode, merged from all components.
Bank learn_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                const BankOptions& options, const Eigen::MatrixXd& R, const MotionModel* motion = nullptr);

/// Replaces Refine::automatic by em or none (see Refine); other values do not change. `linear`: whether the model of
/// the windows is linear.
Refine refinement_asked(const BankOptions& options, bool linear);

/// Calls learn_refined_bank or learn_bank, as refinement_asked decides. Only learn_refined_bank needs `filter`. Throws
/// std::invalid_argument for refinement of a motion model.
Refinement learn_as_asked(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                          const BankOptions& options, const Eigen::MatrixXd& R,
                          const std::optional<FilterOptions>& filter, const MotionModel* motion);

/// Calls learn_bank, then refine_bank. Starts are the mixture's bank and smaller banks. Smaller banks come from merging
/// the closest components (merge_components), each time to three quarters of the modes, down to one. One mode wins if
/// more modes do not gain on training runs that were left out, for example with little data. The mixture's own bank is
/// `start` of the result.
Refinement learn_refined_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                              const BankOptions& options, const Eigen::MatrixXd& R, const FilterOptions& filter);

}  // namespace modebank
