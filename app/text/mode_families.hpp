#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/text/mode_dynamics.hpp"
#include "app/text/mode_words.hpp"
#include "io/archive/archive.hpp"

/// Families of modes: modes that are one thing to people. Where sliding tyres need five linear models, all five are
/// "ice". The archive holds modes alone; families follow from it here, for every reader.
///
/// - Modes of one name (a label of the data, or bank.mode_names) are one family.
/// - Modes without a name are one family where each two of them are near: the slowest time constant and every gain
///   differ by at most two standard errors of the difference (complete linkage), and both or neither oscillate.
/// - A vague mode without a name is a family by itself: it would be near to all others.
namespace modebank::app {

/// A number of several modes: the mean by their weights. Its variance is the mean of the modes' variances plus the
/// variance of the modes' values (law of total variance): what to expect of a sample whose mode is not known.
struct PooledNumber {
  double value = 0.0, error = 0.0;  ///< NaN where they are not known
};
/// `weights` need not sum to one; where they sum to zero each counts the same.
PooledNumber pooled_number(const Eigen::VectorXd& values, const Eigen::VectorXd& errors,
                           const Eigen::VectorXd& weights);

struct ModeFamily {
  std::string name;            ///< of its modes, on one line; may be empty
  std::vector<Index> modes;    ///< numbers of the archive, most used first
  std::vector<double> uses;    ///< of each
  std::vector<Index> counted;  ///< modes that its numbers are means of: the vague ones do not count beside others
  double use = 0.0;            ///< of all of them
  double stay_s = 0.0;         ///< mean stay in the family, as UsedMode has it for a mode
  bool at_least = false;
  Decay slowest;                     ///< of a family of one its mode's, else a mean without a period
  Eigen::MatrixXd gain, gain_error;  ///< n_y x recorded inputs; NaN where no mode has one

  /// "ice (modes 0, 5, 3)", "mode 4: grip", "modes 2, 7".
  std::string title() const;
  /// "0, 5, 3"; of more than `most` modes the first ones and "..".
  std::string numbers(std::size_t most = std::string::npos) const;
};

/// All families, the most used first: their numbers. `open`: gains and decays that no data determine, as
/// mode_words.hpp has them; `modes`: as used_modes.
struct OpenNumbers {
  bool decays = false;
  std::vector<bool> gains;  ///< states x inputs, a state's in a row
};
std::vector<ModeFamily> mode_families(const Bank& bank, const std::vector<std::string>& names,
                                      const std::vector<UsedMode>& modes, const OpenNumbers& open);
/// Those of the archive's bank on the judged runs.
std::vector<ModeFamily> mode_families(const Archive& archive);

/// The place of each mode's family.
std::vector<Index> family_of_modes(const std::vector<ModeFamily>& families);

}  // namespace modebank::app
