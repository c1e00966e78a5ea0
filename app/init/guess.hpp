#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/init/survey.hpp"
#include "app/init/words.hpp"

namespace modebank::app {

/// Where a channel stands in what was surveyed.
struct ChannelPlace {
  std::size_t file = 0, table = 0, channel = 0;
  bool operator==(const ChannelPlace&) const = default;
};

const SurveyedChannel& channel_at(const std::vector<SurveyedFile>& files, const ChannelPlace& place);

/// A gyro that is mounted on its side: gravity lies along another axis than z.
struct Mounting {
  Axis up = Axis::z;            ///< the axis that gravity lies along
  bool reversed = false;        ///< whether it points down
  double gravity = 0.0;         ///< mean acceleration along it [m/s^2]
  std::string z_rate, up_rate;  ///< angular rates about z, as named, and about the axis that points up
  /// Correlation of either with the yaw rate that another table measures, where one does.
  std::optional<double> z_correlation, up_correlation;
  std::string other;  ///< that yaw rate
};

/// A channel that moves and has no part.
struct ChannelLeft {
  std::string name, reason;
};

struct Guess {
  std::vector<ChannelPlace> states, inputs;
  std::optional<Mounting> mounting;
  std::vector<std::string> reasons;  ///< in words, for the configuration's comments
};

/// States and inputs by names, units, movement and position, each a hint with a weight. Throws DataError when no
/// channel moves.
Guess guess_roles(const std::vector<SurveyedFile>& files);

/// The channels that move and that `guess` leaves out, with the reason, in the order of the files.
std::vector<ChannelLeft> channels_left(const std::vector<SurveyedFile>& files, const Guess& guess);

}  // namespace modebank::app
