#pragma once

#include <string>
#include <vector>

#include "app/text/mode_dynamics.hpp"
#include "app/text/mode_words.hpp"
#include "io/archive/archive.hpp"

/// The motions of a bank in words. Modes of one motion share theta and differ in noise (Bank::motion).
namespace modebank::app {

struct Motion {
  Index number = 0;          ///< in Bank::motion
  std::string name;          ///< that all its modes have, on one line; may be empty
  std::vector<Index> modes;  ///< numbers of the modes in the archive, the most used mode first
  double use = 0.0;          ///< sum of the modes' uses
  double stay_s = 0.0;       ///< mean stay in the motion, computed like a mode's stay in UsedMode
  bool at_least = false;
  Decay slowest;                     ///< of the modes' common theta, without its period
  Eigen::MatrixXd gain, gain_error;  ///< n_y x recorded inputs, of the modes' common theta

  /// Text such as "ice (modes 0, 5, 3)", "mode 4: grip" or "modes 2, 7".
  std::string title() const;
  /// Text such as "0, 5, 3". After `most` numbers it ends in "..".
  std::string numbers(std::size_t most = std::string::npos) const;
};

/// The most used motion first. `modes`: all modes of the bank, the most used mode first.
std::vector<Motion> motions_of(const Bank& bank, const std::vector<std::string>& names,
                               const std::vector<UsedMode>& modes);
/// Motions of the archive's bank, by their use on the judged runs.
std::vector<Motion> motions_of(const Archive& archive);

/// Number of motions that get their own row in a table. These are the most used ones: at most eight, each with a use of
/// at least 1 %, but at least one. All others share the row "others".
Index told_of(const std::vector<Motion>& motions);

/// Text such as "2 modes" where each mode is a motion of its own, else "2 motions". Passages do not count.
std::string counted_words(const Bank& bank);
/// The same with passages and modes: "2 modes", "2 motions (4 modes: each calm and rough)" or "2 motions and a passage
/// (5 modes)".
std::string motion_words(const Bank& bank);

}  // namespace modebank::app
