#include "app/init/survey_set.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace modebank::app {
namespace {

using Names = std::vector<std::string>;

void add_once(Names& names, const std::string& name) {
  if (std::ranges::count(names, name) == 0) names.push_back(name);
}

SurveyedTable* find_table(SurveyedFile& file, const std::string& name) {
  const auto found =
      std::find_if(file.tables.begin(), file.tables.end(), [&](const SurveyedTable& t) { return t.name == name; });
  return found == file.tables.end() ? nullptr : &*found;
}

/// A channel of the set moves if it moves in at least one file.
void widen(ChannelCheck& check, const ChannelCheck& other) {
  check.least = std::min(check.least, other.least);
  check.largest = std::max(check.largest, other.largest);
  check.missing += other.missing;
}

/// A channel of the set is text if it is text in at least one file.
void be_text(SurveyedChannel& ours, const SurveyedChannel& theirs) {
  ours.values.resize(0);
  if (ours.why_text.empty()) ours.why_text = theirs.why_text;
}

/// Merges the same table of another file into `table`. Names of channels that only one of the files has are added to
/// `partial`.
void merge(SurveyedTable& table, const SurveyedTable& other, Names& partial) {
  if (!table.form.patterns.empty() && !other.form.patterns.empty()) join_patterns(table.form, other.form);
  std::erase_if(table.channels, [&](const SurveyedChannel& channel) {
    if (other.find(channel.name) != nullptr) return false;
    add_once(partial, channel.name);
    return true;
  });
  for (const SurveyedChannel& theirs : other.channels) {
    const auto ours = std::find_if(table.channels.begin(), table.channels.end(),
                                   [&](const SurveyedChannel& c) { return c.name == theirs.name; });
    if (ours == table.channels.end())
      add_once(partial, theirs.name);
    else if (ours->is_number() && theirs.is_number()) {
      widen(ours->check, theirs.check);
      ours->rests = ours->rests && theirs.rests;
    } else
      be_text(*ours, theirs);
  }
}

void merge(SurveyedFile& all, SurveyedFile&& other, Names& partial) {
  std::erase_if(all.tables, [&](const SurveyedTable& table) {
    if (find_table(other, table.name) != nullptr) return false;
    add_once(partial, table.name);
    return true;
  });
  for (const SurveyedTable& theirs : other.tables)
    if (SurveyedTable* const ours = find_table(all, theirs.name))
      merge(*ours, theirs, partial);
    else
      add_once(partial, theirs.name);
  for (const std::string& note : other.notes) add_once(all.notes, note);
  all.skipped_alike = all.skipped_alike && all.skipped == other.skipped;
}

}  // namespace

SurveyedFile survey_set(const FileSet& set) {
  SurveyedFile all = survey_file(set.files.front());
  Names partial;
  for (std::size_t i = 1; i < set.files.size(); ++i) merge(all, survey_file(set.files[i]), partial);
  if (!partial.empty())
    all.notes.push_back(
        fmt::format("left out, because they are not in all {} files: {}", set.files.size(), fmt::join(partial, ", ")));
  return all;
}

}  // namespace modebank::app
