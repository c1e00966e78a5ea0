#include "app/init/init_json.hpp"

#include <nlohmann/json.hpp>

#include "ident/check/stream_check.hpp"

namespace modebank::app {
namespace {

using nlohmann::json;

json channel_json(const SurveyedChannel& channel) {
  json object{{"name", channel.name}, {"unit", channel.unit}, {"type", channel.type}};
  if (!channel.is_number()) return object;
  object["least"] = channel.check.least;
  object["largest"] = channel.check.largest;
  object["missing"] = channel.check.missing;
  object["quantum"] = channel.check.quantum;
  object["repeated"] = channel.check.repeated;
  return object;
}

json table_json(const SurveyedTable& table) {
  json channels = json::array();
  for (const SurveyedChannel& channel : table.channels) channels.push_back(channel_json(channel));
  return {{"name", table.name},
          {"type", table.type},
          {"rows", table.time_s.size()},
          {"time", table.time},
          {"runs_by", table.run},
          {"rate_hz", table.sampling.rate_hz},
          {"duration_s", table.sampling.duration_s},
          {"gaps", table.sampling.gaps},
          {"channels", channels}};
}

}  // namespace

json init_json(const std::vector<SurveyedFile>& surveyed, const Proposal& proposal) {
  json files = json::array(), keys = json::array();
  for (const SurveyedFile& file : surveyed) {
    json tables = json::array();
    for (const SurveyedTable& table : file.tables) tables.push_back(table_json(table));
    files.push_back({{"file", file.path.string()}, {"notes", file.notes}, {"tables", tables}});
  }
  for (const ProposedKey& key : proposal.keys)
    keys.push_back({{"key", "data." + key.key}, {"value", key.value}, {"why", key.why}});
  json left = json::array();
  for (const ChannelLeft& channel : proposal.left) left.push_back({{"name", channel.name}, {"reason", channel.reason}});
  return {{"files", files}, {"keys", keys}, {"doubts", proposal.doubts}, {"not_taken", left}};
}

}  // namespace modebank::app
