#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/init/proposal.hpp"
#include "ident/base/printable.hpp"

namespace modebank::app {
namespace {

/// Channels with the same reason share a line.
std::string left_text(const std::vector<ChannelLeft>& left) {
  std::vector<std::string> reasons;
  for (const ChannelLeft& channel : left)
    if (std::find(reasons.begin(), reasons.end(), channel.reason) == reasons.end()) reasons.push_back(channel.reason);
  std::string text;
  for (const std::string& reason : reasons) {
    std::vector<std::string> names;
    for (const ChannelLeft& channel : left)
      if (channel.reason == reason) names.push_back(printable_name(channel.name));
    text += fmt::format("# not taken, {}: {}\n", reason, first_of(names));
  }
  return text;
}

}  // namespace

std::string first_of(std::vector<std::string> names) {
  constexpr std::size_t most = 6;
  const std::size_t more = names.size() - std::min(names.size(), most);
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

std::string configuration_text(const Proposal& proposal, const std::string& command) {
  constexpr std::size_t longest = 100;
  const std::string shown =
      command.size() > longest ? command.substr(0, command.rfind(' ', longest)) + " ..." : command;
  std::string text = fmt::format("# Written by {}. Check the lines below before you use it.\n", printable_name(shown));
  for (const std::string& doubt : proposal.doubts) text += fmt::format("# ! {}\n", printable_name(doubt));
  text += "\n[data]\n";
  for (const ProposedKey& key : proposal.keys) {
    if (key.value.empty()) {
      text += fmt::format("# {}\n", key.why);
      continue;
    }
    const std::string line = fmt::format("{} = {}", key.key, key.value == " " ? "" : key.value);
    text += key.why.empty() ? line + "\n" : fmt::format("{:<40}  # {}\n", line, printable_name(key.why));
  }
  if (!proposal.left.empty()) text += "\n" + left_text(proposal.left);
  text +=
      "\n# All other keys have their defaults. `modebank help KEY` explains a key. `modebank check` on this file tests "
      "the data.\n";
  return text;
}

}  // namespace modebank::app
