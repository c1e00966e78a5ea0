#include "app/init/confirm.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/algorithm/string.hpp>
#include <istream>
#include <optional>
#include <ostream>

#include "ident/base/nearest_name.hpp"
#include "ident/base/printable.hpp"

namespace modebank::app {
namespace {

std::string names_of(const std::vector<SurveyedFile>& files, const std::vector<ChannelPlace>& places) {
  std::vector<std::string> names;
  for (const ChannelPlace& place : places) names.push_back(channel_at(files, place).name);
  return names.empty() ? "none" : printable_name(fmt::format("{}", fmt::join(names, ", ")));
}

/// Place of the moving channel with this name. If several have the name, the first.
std::optional<ChannelPlace> find_moving(const std::vector<SurveyedFile>& files, const std::string& name) {
  for (std::size_t f = 0; f < files.size(); ++f)
    for (std::size_t t = 0; t < files[f].tables.size(); ++t)
      for (std::size_t c = 0; c < files[f].tables[t].channels.size(); ++c)
        if (const ChannelPlace place{f, t, c};
            channel_at(files, place).name == name && channel_at(files, place).moves())
          return place;
  return std::nullopt;
}

std::vector<std::string> moving_channels(const std::vector<SurveyedFile>& files) {
  std::vector<std::string> names;
  for (const SurveyedFile& file : files)
    for (const SurveyedTable& table : file.tables)
      for (const SurveyedChannel& channel : table.channels)
        if (channel.moves()) names.push_back(channel.name);
  return names;
}

/// Reads the channels that a line of input names. Returns an error message if one is not found.
std::optional<std::vector<ChannelPlace>> places_of(const std::vector<SurveyedFile>& files, const std::string& line,
                                                   std::ostream& questions) {
  std::vector<std::string> names;
  boost::split(names, line, boost::is_any_of(","));
  std::vector<ChannelPlace> places;
  for (std::string& name : names) {
    boost::trim(name);
    const std::optional<ChannelPlace> place = find_moving(files, name);
    if (!place) {
      questions << printable(
          fmt::format("  no moving channel has the name {}{}\n", name, did_you_mean(name, moving_channels(files))));
      return std::nullopt;
    }
    places.push_back(*place);
  }
  return places;
}

/// Asks the user for channels. Returns whether the user changed any.
bool ask(const std::vector<SurveyedFile>& files, const char* what, std::vector<ChannelPlace>& places, bool may_be_none,
         std::istream& answers, std::ostream& questions) {
  std::string line;
  while (questions << fmt::format("{} [{}]: ", what, names_of(files, places)) << std::flush,
         std::getline(answers, line)) {
    boost::trim(line);
    if (line.empty()) return false;
    if (may_be_none && line == "none") {
      places.clear();
      return true;
    }
    if (const auto chosen = places_of(files, line, questions)) {
      places = *chosen;
      return true;
    }
  }
  questions << "\n";
  return false;
}

}  // namespace

void confirm_roles(const std::vector<SurveyedFile>& files, Guess& guess, std::istream& answers,
                   std::ostream& questions) {
  questions << "Press Return to keep the channels in brackets, or type other names with commas between them.\n";
  if (ask(files, "state (measured)", guess.states, false, answers, questions)) guess.mounting.reset();
  ask(files, "input (acts on the state; or none)", guess.inputs, true, answers, questions);
}

}  // namespace modebank::app
