#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/init/survey.hpp"
#include "app/init/words.hpp"

namespace modebank::app {

/// Position of a channel in the survey's files and tables.
struct ChannelPlace {
  std::size_t file = 0, table = 0, channel = 0;
  bool operator==(const ChannelPlace&) const = default;
};

const SurveyedChannel& channel_at(const std::vector<SurveyedFile>& files, const ChannelPlace& place);

/// Mounting of a gyro that lies on its side, so that gravity does not act along z.
struct Mounting {
  Axis up = Axis::z;            ///< axis along which gravity acts
  bool reversed = false;        ///< whether this axis points down
  double gravity = 0.0;         ///< mean acceleration along this axis [m/s^2]
  std::string z_rate, up_rate;  ///< channels of angular rate about z, and about the axis that points up
  /// Correlation of each with the yaw rate of another table, if there is one.
  std::optional<double> z_correlation, up_correlation;
  std::string other;  ///< name of the other table's yaw rate
};

/// A channel that moves but is neither a state nor an input.
struct ChannelLeft {
  std::string name, reason;
  int points = 0;  ///< hints that it acts or is measured; 0 for clocks, counters, labels and text
};

struct Guess {
  std::vector<ChannelPlace> states, inputs;
  std::optional<Mounting> mounting;
  std::vector<std::string> reasons;  ///< sentences for the configuration's comments
};

/// Guesses states and inputs from names, units, movement and position. Each hint has a weight. Throws DataError if no
/// channel moves, or if the states and inputs, or the rows of their table, do not belong together: one of many
/// recordings in a file, another robot's input, signals in one column, each signal with its own times, or vectors in
/// one cell. Such a message has the key that decides, or lines of Python that make a table.
Guess guess_roles(const std::vector<SurveyedFile>& files);

/// Moving channels that are not in `guess`, each with the reason, those first that are likely to act.
std::vector<ChannelLeft> channels_left(const std::vector<SurveyedFile>& files, const Guess& guess);

}  // namespace modebank::app
