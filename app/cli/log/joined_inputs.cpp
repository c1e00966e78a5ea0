#include "app/cli/log/joined_inputs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "app/cli/log/log_configuration.hpp"
#include "app/config/option_text.hpp"
#include "app/init/words.hpp"
#include "ident/lag/identifiable.hpp"
#include "io/import/import.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

using Eigen::Index;

constexpr const char* alike_words = ", so the log cannot tell them apart";
constexpr const char* resting_words =
    ", so a controller with a set point at rest computes it, and the log cannot tell that from the plant: record a run "
    "in which the set point moves";

std::vector<std::string> names_of_columns(const Recording& recording) {
  std::vector<std::string> names = names_of(recording.states);
  for (const std::string& input : names_of(recording.inputs)) names.push_back(input);
  return names;
}

std::string name_at(const std::string& name, Index lag) { return lag == 0 ? name : fmt::format("{}[k-{}]", name, lag); }

/// "throttle = 2.000 (speed_setpoint - speed) in every sample".
std::string relation_words(const ColumnRelation& relation, const std::vector<std::string>& names) {
  constexpr double alike = 1e-3;  // relative difference of two coefficients that count as equal
  const auto name = [&](Index column) { return names[static_cast<std::size_t>(column)]; };
  if (!relation.complete) {
    std::vector<std::string> joined;
    for (const Index column : relation.joined) joined.push_back(name(column));
    return fmt::format("{} follows from the last 20 samples of {} in every sample", name(relation.column),
                       fmt::join(joined, ", "));
  }
  std::string text = name(relation.column) + " =";
  const std::vector<ColumnRelation::Term>& terms = relation.terms;
  if (terms.size() == 2 &&
      std::abs(terms[0].coefficient + terms[1].coefficient) < alike * std::abs(terms[0].coefficient)) {
    const std::size_t plus = terms[0].coefficient > 0.0 ? 0 : 1;
    text +=
        fmt::format(" {:#.4g} ({} - {})", terms[plus].coefficient, name_at(name(terms[plus].column), terms[plus].lag),
                    name_at(name(terms[1 - plus].column), terms[1 - plus].lag));
  } else {
    for (const ColumnRelation::Term& term : terms) {
      const char* const sign = term.coefficient < 0.0 ? "-" : text.back() == '=' ? "" : "+";
      text += fmt::format(" {}{}{:#.4g} {}", sign, *sign == '\0' ? "" : " ", std::abs(term.coefficient),
                          name_at(name(term.column), term.lag));
    }
  }
  if (relation.constant != 0.0)
    text += fmt::format(" {} {:#.4g}", relation.constant < 0.0 ? "-" : "+", std::abs(relation.constant));
  return text + " in every sample";
}

/// The input of a relation to leave out: a named set point, which acts through another; else the explained one.
Index input_to_leave(const ColumnRelation& relation, const std::vector<std::string>& names, Index states) {
  std::vector<Index> inputs{relation.column};
  for (const Index column : relation.joined)
    if (column >= states) inputs.push_back(column);
  const auto set_point = std::find_if(inputs.begin(), inputs.end(), [&](Index column) {
    return !words_of_measured(names[static_cast<std::size_t>(column)]).empty();
  });
  return set_point == inputs.end() ? relation.column : *set_point;
}

}  // namespace

void remove_input(Recording& recording, Index input) {
  recording.inputs.erase(recording.inputs.begin() + input);
  for (Trajectory& run : recording.runs) {
    const Eigen::MatrixXd all = run.input;
    run.input.resize(all.rows() - 1, all.cols());
    run.input << all.topRows(input), all.bottomRows(all.rows() - 1 - input);
  }
}

void leave_out_joined_inputs(const std::filesystem::path& file, const std::filesystem::path& archive,
                             const std::string& typed, bool stated, Proposal& proposal) {
  const Config config = LogConfiguration(proposal, typed).config(file, archive);
  Recording recording = import_data(data_options_of(config)).recording;
  std::vector<std::string> kept = config.data.input, units = config.data.input_unit;
  if (kept.size() != recording.inputs.size()) return;
  while (!recording.inputs.empty()) {
    const Identifiability found = identifiable(recording, decimal_steps(recording));
    const Index n = recording.state_count();
    const auto relation = std::find_if(found.relations.begin(), found.relations.end(), [&](const ColumnRelation& one) {
      return one.column >= n && (one.complete || !one.follows_states);  // a smooth set point also gives 20 lags
    });
    if (relation == found.relations.end()) return;
    const std::vector<std::string> names = names_of_columns(recording);
    const std::string words = relation_words(*relation, names);
    if (relation->follows_states) throw DataError(words + resting_words);
    if (stated) return;
    const Index out = input_to_leave(*relation, names, n) - n;
    proposal.doubt(fmt::format("{}{}: {} is left out of the inputs", words, alike_words,
                               names[static_cast<std::size_t>(n + out)]));
    kept.erase(kept.begin() + out);
    remove_input(recording, out);
    proposal.set("input", format_value(kept), words);
    if (units.size() < 2) continue;  // none, or one for all
    units.erase(units.begin() + out);
    proposal.set("input_unit", format_value(units), "guessed from the names");
  }
}

std::vector<std::string> joined_doubts(const Recording& recording) {
  const std::vector<std::string> names = names_of_columns(recording);
  const Index n = recording.state_count();
  const Identifiability found = identifiable(recording, decimal_steps(recording));
  std::vector<std::string> doubts;
  for (const Index column : found.resting)
    if (column >= n)
      doubts.push_back(names[static_cast<std::size_t>(column)] +
                       " never moves, so the log shows nothing of its effect: leave it out of data.input");
  std::set<std::set<Index>> told;
  for (const ColumnRelation& relation : found.relations) {
    std::set<Index> columns(relation.joined.begin(), relation.joined.end());
    columns.insert(relation.column);
    if (relation.column >= n && told.insert(std::move(columns)).second)
      doubts.push_back(relation_words(relation, names) +
                       (relation.complete && relation.follows_states ? resting_words : alike_words));
  }
  return doubts;
}

}  // namespace modebank::app
