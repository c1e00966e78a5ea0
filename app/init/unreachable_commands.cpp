#include "app/init/unreachable_commands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

namespace modebank::app {
namespace {

constexpr std::array command_words{" cmd ", " command ", " commanded ", " setpoint ", " desired ", " target "};
constexpr std::array measured_words{" wheel ", " measured ", " meas ", " actual ", " encoder ", " feedback "};

double reach_of(const SurveyedChannel& channel) {
  return std::max(std::abs(channel.check.least), std::abs(channel.check.largest));
}

/// The channel in the command's table that measures the same quantity; empty if there is none.
std::optional<std::size_t> counterpart(const SurveyedTable& table, const SurveyedChannel& command) {
  const std::string rest = words_without(command_words, command.name);
  if (rest.empty()) return std::nullopt;
  for (std::size_t c = 0; c < table.channels.size(); ++c)
    if (table.channels[c].moves() && words_without(measured_words, table.channels[c].name) == rest) return c;
  return std::nullopt;
}

/// Whether a tenth of the commands exceeds all measurements by a fifth. Both must have the same unit. The measurements
/// must also follow moderate commands, with a slope between 0.5 and 2.
bool is_beyond_reach(const SurveyedChannel& command, const SurveyedChannel& measured) {
  constexpr double beyond = 1.2, least_share = 0.1, moderate = 0.5, least_slope = 0.5, largest_slope = 2.0;
  const Eigen::ArrayXd c = command.values, m = measured.values, reached = c.abs() / reach_of(measured);
  const Eigen::Array<bool, Eigen::Dynamic, 1> known = c.isFinite() && m.isFinite(),
                                              usual = known && reached <= moderate;
  const double slope = usual.select(c * m, 0.0).sum() / usual.select(c.square(), 0.0).sum();  // NaN without any
  const auto share = (known && reached > beyond).cast<double>().sum() / known.cast<double>().sum();
  return share > least_share && slope > least_slope && slope < largest_slope;
}

}  // namespace

void replace_unreachable_commands(const std::vector<SurveyedFile>& files, Guess& guess) {
  std::vector<ChannelPlace> places;
  std::vector<std::string> commands, measured;
  double commanded = 0.0, reached = 0.0;
  bool beyond = false;
  for (const ChannelPlace& place : guess.inputs) {
    const SurveyedTable& table = files[place.file].tables[place.table];
    const SurveyedChannel& command = channel_at(files, place);
    const std::optional<std::size_t> found = counterpart(table, command);
    if (!found) return;
    places.push_back({place.file, place.table, *found});
    const SurveyedChannel& other = channel_at(files, places.back());
    if (std::count(guess.states.begin(), guess.states.end(), places.back()) > 0) return;
    beyond = beyond || is_beyond_reach(command, other);
    commanded = std::max(commanded, reach_of(command));
    reached = std::max(reached, reach_of(other));
    commands.push_back(command.name);
    measured.push_back(other.name);
  }
  if (!beyond) return;
  guess.inputs = std::move(places);
  guess.reasons.push_back(fmt::format(
      "{0} reach {1:.3g}, but {2} never exceed {3:.3g}: many commands are not followed, so the measured values are the "
      "inputs; the commands would be data.input = {0}",
      fmt::join(commands, ", "), commanded, fmt::join(measured, ", "), reached));
}

}  // namespace modebank::app
