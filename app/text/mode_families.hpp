#pragma once

#include <string>
#include <vector>

#include "app/text/mode_dynamics.hpp"
#include "app/text/mode_words.hpp"
#include "io/archive/archive.hpp"

/// Families of modes. A family is a group of modes that mean the same to a user. If sliding tyres need five linear
/// models, all five are the family "ice". The archive contains only modes; every reader computes the families with this
/// file.
///
/// - Modes with the same name (a label of the data, or bank.mode_names) form one family.
/// - Modes without a name form one family if each two of them are near. Two modes are near if their slowest time
///   constants and all gains differ by at most two standard errors of the difference (complete linkage). Also, both or
///   neither must oscillate.
/// - A vague mode without a name is a family of its own, because it would be near to every other mode.
namespace modebank::app {

/// A number for several modes: the weighted mean of the modes' values. Its variance is the mean of the modes' variances
/// plus the variance of the values (law of total variance). This is the uncertainty for a sample whose mode is unknown.
struct PooledNumber {
  double value = 0.0, error = 0.0;  ///< NaN if unknown
};
/// Weights that sum to one. If the given ones sum to zero, all are equal.
Eigen::VectorXd shares_of(const Eigen::VectorXd& weights);
/// `weights` as in shares_of.
PooledNumber pooled_number(const Eigen::VectorXd& values, const Eigen::VectorXd& errors,
                           const Eigen::VectorXd& weights);

struct ModeFamily {
  std::string name;            ///< name that the modes share, on one line; may be empty
  std::vector<Index> modes;    ///< numbers of the modes in the archive, the most used mode first
  std::vector<double> uses;    ///< of each
  std::vector<Index> counted;  ///< modes that enter the means; vague modes enter only if there are no others
  double use = 0.0;            ///< sum of the modes' uses
  double stay_s = 0.0;         ///< mean stay in the family, computed like a mode's stay in UsedMode
  bool at_least = false;
  Decay slowest;                     ///< decay of the mode in a family of one mode; else a mean, which has no period
  Eigen::MatrixXd gain, gain_error;  ///< n_y x recorded inputs; NaN if no mode has this gain

  /// Text such as "ice (modes 0, 5, 3)", "mode 4: grip" or "modes 2, 7".
  std::string title() const;
  /// Text such as "0, 5, 3". After `most` numbers it ends in "..".
  std::string numbers(std::size_t most = std::string::npos) const;
};

/// Decays and gains that the training runs leave unidentifiable (mode_words.hpp).
struct UnidentifiableNumbers {
  bool decays = false;
  std::vector<bool> gains;  ///< for each gain (states x inputs, row by row)
};
std::vector<ModeFamily> mode_families(const Bank& bank, const std::vector<std::string>& names,
                                      const std::vector<UsedMode>& modes, const UnidentifiableNumbers& unidentifiable);
/// Families of the modes of the archive's bank, by their use on the judged runs.
std::vector<ModeFamily> mode_families(const Archive& archive);

/// For each mode, the index of its family.
std::vector<Index> family_of_modes(const std::vector<ModeFamily>& families);

}  // namespace modebank::app
