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

/// A bank without modes. C = [I 0] selects the newest sample of z; R is at least the variance of rounding. Throws
/// std::invalid_argument if sizes disagree.
Bank bank_frame(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R);

/// The stated R, if options.measurement_variance is set; otherwise `R`.
Eigen::MatrixXd stated_or(const BankOptions& options, const Eigen::MatrixXd& R);

/// Names of a bank's states and inputs; a lagged state is called "wz[k-1]".
std::vector<std::string> state_names(const Recording& recording, const LinearStructure& structure);
std::vector<std::string> input_names(const Recording& recording, const LinearStructure& structure);

/// The mode with theta and process noise `Q` of the measured states; lagged samples have no noise.
Mode make_mode(const LinearStructure& structure, const Eigen::VectorXd& theta, const Eigen::MatrixXd& Q,
               const Eigen::MatrixXd& parameter_covariance, const Eigen::VectorXd& standard_error, double weight);

/// Removes the standard errors of parameters that the training runs do not determine, by the global covariance's NaN.
void clear_unidentifiable(Bank& bank, const Eigen::MatrixXd& global_covariance);

/// Sets the transition matrix, with uniform initial probabilities.
void set_mode_sequence(Bank& bank, const TransitionMatrix& transition);

/// Added to every count of label transitions, so that no transition is impossible.
inline constexpr double label_count_smoothing = 0.1;

/// K x K counts of (label i, then label j) over neighbouring windows: same run, starts one `step` apart. Mode j is the
/// component kept[j]. A window without a mode (label -1), such as one that contains a switch, counts as the previous
/// mode, so the switch is counted once.
Eigen::MatrixXd count_label_transitions(const WindowFits& fits, const Eigen::VectorXi& labels,
                                        const std::vector<Index>& kept);

/// Normalises smoothed counts by rows and converts from one window step (`step` transitions) to one transition: the
/// diagonal becomes T_ii^(1/step); the rest of the row is scaled.
TransitionMatrix transition_from_counts(const Eigen::MatrixXd& counts, Index step);

/// Converts clustered windows into a bank (method: section 4). `motion`: motion model of the windows, null for linear
/// models. If every component is screened out, the bank has one mode, merged from all components. Throws
/// std::invalid_argument for a mixture of other windows.
Bank learn_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                const BankOptions& options, const Eigen::MatrixXd& R, const MotionModel* motion = nullptr);

/// Replaces Refine::automatic by em or none (see Refine); other values do not change. `linear`: whether the model of
/// the windows is linear.
Refine refinement_asked(const BankOptions& options, bool linear);

/// Calls learn_refined_bank, which needs `filter`, or learn_bank, as refinement_asked decides. Throws
/// std::invalid_argument for refinement of a motion model.
Refinement learn_as_asked(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                          const BankOptions& options, const Eigen::MatrixXd& R,
                          const std::optional<FilterOptions>& filter, const MotionModel* motion);

/// Calls learn_bank, then refine_bank. Starts are the mixture's bank and smaller ones, from merging the closest
/// components, each time to three quarters of the modes, down to one. The mixture's own bank is `start` of the result.
Refinement learn_refined_bank(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture,
                              const BankOptions& options, const Eigen::MatrixXd& R, const FilterOptions& filter);

}  // namespace modebank
