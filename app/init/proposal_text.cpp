#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/init/proposal.hpp"
#include "ident/base/printable.hpp"

namespace modebank::app {
namespace {

/// Channels with the same reason share a line. Of many names, only the first few are written.
std::string left_text(const std::vector<ChannelLeft>& left) {
  constexpr std::size_t named = 8;
  std::vector<std::string> reasons;
  for (const ChannelLeft& channel : left)
    if (std::find(reasons.begin(), reasons.end(), channel.reason) == reasons.end()) reasons.push_back(channel.reason);
  std::string text;
  for (const std::string& reason : reasons) {
    std::vector<std::string> names;
    for (const ChannelLeft& channel : left)
      if (channel.reason == reason) names.push_back(printable_name(channel.name));
    const std::size_t more = names.size() - std::min(names.size(), named);
    names.resize(names.size() - more);
    text += fmt::format("# not taken, {}: {}{}\n", reason, fmt::join(names, ", "),
                        more > 0 ? fmt::format(" and {} more", more) : "");
  }
  return text;
}

}  // namespace

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
