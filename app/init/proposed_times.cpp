#include "app/init/proposed_times.hpp"

#include <fmt/format.h>

#include "app/init/words.hpp"
#include "io/import/expression.hpp"

namespace modebank::app {
namespace {

/// Whether a note only repeats the unit in the column's name. All other notes state what the values showed.
bool is_of_stated_unit(const SurveyedTable& of, const std::string& note) {
  return of.form.ground == StampForm::Ground::stated && note.starts_with(fmt::format("column {} ", of.time.front()));
}

std::string why_time(const SurveyedTable& of) {
  using Ground = StampForm::Ground;
  if (of.time.size() > 1) return of.form.ground == Ground::text ? "date and time of day" : "seconds and nanoseconds";
  for (const std::string& note : of.time_notes)
    if (is_of_stated_unit(of, note)) return note;
  return "";
}

/// Adds doubts about the format of the stamps.
void propose_form(const SurveyedTable& of, Proposal& proposal) {
  for (const std::string& note : of.time_notes)
    if (!is_of_stated_unit(of, note)) proposal.doubt(note);
  const SurveyedChannel* column = of.find(of.time.front());
  if (column != nullptr && column->type != "time" && !column->unit.empty() && !stated_time_unit(column->unit))
    proposal.doubt(fmt::format("unknown unit of time {}: {} is taken for {} (change data.time_unit if that is wrong)",
                               column->unit, of.time.front(), in_words(of.form.unit)));
  if (of.form.patterns.size() < 2) return;
  proposal.add("time_format", of.form.patterns.front(), "guessed: day and month may be swapped");
  proposal.doubt(fmt::format("times such as {} can be read in two ways: {} and {} (data.time_format)", of.form.value,
                             of.form.patterns[0], of.form.patterns[1]));
}

}  // namespace

void propose_times(const SurveyedTable& states, const SurveyedTable& inputs, Proposal& proposal) {
  const auto own = [](const SurveyedTable& of) {
    const SurveyedChannel* first = of.time.empty() ? nullptr : of.find(of.time.front());
    return first != nullptr && first->type == "time";
  };
  if (states.time.empty() || inputs.time.empty()) {
    proposal.add("time", " ", "no column of times was found; row k is at k / rate_hz");
    proposal.add("rate_hz", "1", "samples per second: CHANGE THIS to the rate of your log");
    proposal.doubt("no column of times was found; state data.time or change data.rate_hz = 1 to the rate of your log");
    for (const SurveyedTable* of : {&states, &inputs})
      if (!of->time_problem.empty()) proposal.doubt(of->time_problem + " (data.time or data.rate_hz)");
    return;
  }
  if (states.time_guessed)
    proposal.doubt(fmt::format("{} rises evenly, {:.4g} times a second, and is taken for the times (data.time)",
                               states.time.front(), states.sampling.rate_hz));
  propose_form(states, proposal);
  if (own(states) && own(inputs))
    return;  // the default stamps of a recording need no data.time, so this key is not written
  const std::string time = listed_channel_names(states.time);
  if (states.time != inputs.time)
    proposal.doubt(fmt::format("the column of times is {} in one table and {} in the other; data.time takes one name",
                               time, listed_channel_names(inputs.time)));
  if (time != "time") proposal.add("time", time, why_time(states));
}

}  // namespace modebank::app
