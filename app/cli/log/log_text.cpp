#include "app/cli/log/log_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/text/first_screen.hpp"
#include "app/text/terminal.hpp"
#include "ident/base/printable.hpp"

namespace modebank::app {
namespace {

const SurveyedTable& table_of(const std::vector<SurveyedFile>& surveyed, const ChannelPlace& place) {
  return surveyed[place.file].tables[place.table];
}

std::string value_of(const Proposal& proposal, const std::string& key) {
  const ProposedKey* const found = proposal.find(key);
  return found == nullptr ? "" : found->value;
}

/// "husky.bag" for one file; for several files the first name and the number of files.
std::string files_text(const std::vector<FileSet>& sets) {
  std::vector<std::string> all;
  for (const FileSet& set : sets) {
    const std::string first = printable_name(set.files.front().filename().string());
    all.push_back(set.files.size() == 1 ? first : fmt::format("{} and {} more", first, set.files.size() - 1));
  }
  return fmt::format("{}", fmt::join(all, "; "));
}

std::string time_text(const SurveyedTable& table) {
  if (table.time.empty()) return "the row number, because the log lacks a column of times";
  return fmt::format("{} ({:.4g} Hz, {:.4g} s{})", fmt::join(table.time, " + "), table.sampling.rate_hz,
                     table.sampling.duration_s,
                     table.sampling.gaps > 0 ? fmt::format(", {} gaps", table.sampling.gaps) : "");
}

/// The names of the channels that a key lists, and the formulas of derived channels.
std::string channels_text(const Proposal& proposal, const std::string& key) {
  std::string text = value_of(proposal, key);
  if (text.empty()) return "none: the system moves by itself";
  const std::string unit = value_of(proposal, key + "_unit");
  if (!unit.empty()) text += fmt::format(" [{}]", unit);
  std::vector<std::string> derived;
  for (const ProposedKey& each : proposal.keys) {
    const std::string name = each.value.substr(0, each.value.find_first_of(" ="));
    if (each.key == "derive" && !each.value.empty() &&
        fmt::format(", {},", text).find(" " + name + ",") != std::string::npos)
      derived.push_back(each.value);
  }
  return derived.empty() ? text : fmt::format("{} ({})", text, fmt::join(derived, "; "));
}

/// How the log is split into runs, and which runs are held out.
std::string runs_text(const std::vector<FileSet>& sets, const Proposal& proposal) {
  if (const ProposedKey* const column = proposal.find("run")) return fmt::format("by column {}", column->value);
  if (const ProposedKey* const split = proposal.find("split")) return fmt::format("{} ({})", split->value, split->why);
  const std::size_t files = sets.front().files.size();
  return files > 1 ? fmt::format("{}, one for each file", files) : "one, none of it is held out";
}

}  // namespace

std::string paragraph(const std::string& label, const std::string& text) {
  const int width = standard_output().width;
  const int columns = width > 0 ? std::min(width, screen_columns) : screen_columns;
  return wrapped(fmt::format("{:<10}{}", label, printable_name(text)), columns) + "\n";
}

std::string taken_text(const std::vector<FileSet>& sets, const std::vector<SurveyedFile>& surveyed, const Guess& guess,
                       const Proposal& proposal) {
  const SurveyedTable& states = table_of(surveyed, guess.states.front());
  std::string times = time_text(states);
  if (!guess.inputs.empty())
    if (const SurveyedTable& inputs = table_of(surveyed, guess.inputs.front()); &inputs != &states)
      times += fmt::format("; of the inputs {}", time_text(inputs));
  std::string text = paragraph("log", files_text(sets)) + paragraph("time", times) +
                     paragraph("state", channels_text(proposal, "state")) +
                     paragraph("inputs", channels_text(proposal, "input")) +
                     paragraph("runs", runs_text(sets, proposal));
  for (const std::string& doubt : proposal.doubts) text += paragraph("doubt", doubt);
  return text;
}

}  // namespace modebank::app
