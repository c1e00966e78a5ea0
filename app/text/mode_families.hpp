#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/text/mode_dynamics.hpp"
#include "app/text/mode_words.hpp"
#include "io/archive/archive.hpp"

/// Families of modes: several modes that mean one thing to a user. If sliding tyres need five linear models, all five
/// are the family "ice". The archive contains only modes; every reader derives the families here.
///
/// - Modes with the same name (a label of the data, or bank.mode_names) form one family.
/// - Modes without a name form one family if each two of them are near. Near modes differ in the slowest time constant
///   and in every gain by at most two standard errors of the difference (complete linkage). Both or neither oscillate.
/// - A vague mode without a name is a family of its own, since it would be near to all others.
namespace modebank::app {

/// A number over several modes: the mean by their weights. Its variance is the mean of the modes' variances plus the
/// variance of their values (law of total variance). This is the uncertainty for a sample whose mode is unknown.
struct PooledNumber {
  double value = 0.0, error = 0.0;  ///< NaN if unknown
};
/// `weights` need not sum to one. If they sum to zero, all values count equally.
PooledNumber pooled_number(const Eigen::VectorXd& values, const Eigen::VectorXd& errors,
                           const Eigen::VectorXd& weights);

struct ModeFamily {
  std::string name;            ///< name of the modes, on one line; may be empty
  std::vector<Index> modes;    ///< mode numbers of the archive, most used first
  std::vector<double> uses;    ///< of each
  std::vector<Index> counted;  ///< modes that enter the means: vague modes only if there are no others
  double use = 0.0;            ///< sum over the modes
  double stay_s = 0.0;         ///< mean stay in the family, as in UsedMode for a mode
  bool at_least = false;
  Decay slowest;                     ///< the mode's own decay in a family of one, else a mean without a period
  Eigen::MatrixXd gain, gain_error;  ///< n_y x recorded inputs; NaN if no mode has this gain

  /// "ice (modes 0, 5, 3)", "mode 4: grip", "modes 2, 7".
  std::string title() const;
  /// "0, 5, 3". Shows at most `most` modes, then "..".
  std::string numbers(std::size_t most = std::string::npos) const;
};

/// Decays and gains that the training runs do not determine (mode_words.hpp).
struct OpenNumbers {
  bool decays = false;
  std::vector<bool> gains;  ///< states x inputs, row by row
};
std::vector<ModeFamily> mode_families(const Bank& bank, const std::vector<std::string>& names,
                                      const std::vector<UsedMode>& modes, const OpenNumbers& open);
/// Families of the archive's bank on the judged runs.
std::vector<ModeFamily> mode_families(const Archive& archive);

/// For each mode, the index of its family.
std::vector<Index> family_of_modes(const std::vector<ModeFamily>& families);

}  // namespace modebank::app
