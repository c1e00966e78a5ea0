#include "io/import/import_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "io/import/column_finder.hpp"
#include "io/import/file_patterns.hpp"
#include "io/import/run_roles.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using ColumnNames = std::vector<std::string>;

void check_names(const char* key, const ColumnNames& names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) throw ConfigurationError(fmt::format("data.{}: entry {} is empty", key, i + 1));
    if (std::count(names.begin(), names.end(), names[i]) > 1)
      throw ConfigurationError(fmt::format("data.{}: \"{}\" is named twice", key, names[i]));
  }
}

void check_options(const DataOptions& options) {
  constexpr double highest_rate_hz = 1e6;
  if (options.state.empty()) throw ConfigurationError("data.state is not set: name the state columns");
  if (options.time.empty() && options.rate_hz == 0.0)
    throw ConfigurationError(
        "data.time is not set: name the column of times, or, for rows without any, say data.rate_hz");
  if (options.time.size() > 2)
    throw ConfigurationError("data.time names more than two columns: one, or seconds and nanoseconds");
  check_names("state", options.state);
  check_names("input", options.input);
  check_names("truth", options.truth);
  if (!options.truth.empty() && options.truth.size() != options.state.size())
    throw ConfigurationError(fmt::format("data.truth names {} columns, but data.state {}: one each, or none",
                                         options.truth.size(), options.state.size()));
  if (!(options.rate_hz >= 0.0 && options.rate_hz <= highest_rate_hz))
    throw ConfigurationError(fmt::format("data.rate_hz = {}: must be 0 to {}", options.rate_hz, highest_rate_hz));
  if (!std::isfinite(options.lag_s))
    throw ConfigurationError(fmt::format("data.lag_s = {}: must be finite", options.lag_s));
  if (!(options.lag_range_s > 0.0) || !std::isfinite(options.lag_range_s))
    throw ConfigurationError(fmt::format("data.lag_range_s = {}: must be above 0", options.lag_range_s));
  if (options.lag_auto && options.input.empty())
    throw ConfigurationError("data.lag_s = auto needs inputs (data.input): without one there is no lag");
}

/// The times of all sources, or where rows correspond of the one that is looked up first.
void plan_times(FilePlan& plan, ColumnFinder& find, const DataOptions& options) {
  if (options.join == Join::time) {
    for (std::size_t source = 0; source < plan.sources.size(); ++source) {
      find.time(source, options);
      find.text(source, options.run);
    }
    return;
  }
  const std::size_t timed = find.first_with_time({plan.states_clock, plan.inputs_clock}, options);
  find.time(timed, options);
  if (!options.run.empty()) {
    plan.runs_source = find.first_with(options.run, {plan.states_clock, plan.inputs_clock});
    find.text(plan.runs_source, options.run);
  }
  plan.states_clock = plan.inputs_clock = timed;
}

void plan_columns(FilePlan& plan, const DataOptions& options) {
  FormatOptions format = options.format;
  if (!format.definitions.empty())
    format.definitions = (std::filesystem::path(options.root) / format.definitions).string();
  ColumnFinder find(plan, format);
  const std::size_t inputs = 0, states = plan.paths.size() - 1;
  const std::vector<std::size_t> states_first = states == inputs ? std::vector{inputs} : std::vector{states, inputs};
  plan.state = find.numbers(options.state, {states});
  plan.input = find.numbers(options.input, {inputs});
  plan.states_clock = plan.state.front().source;
  plan.inputs_clock =
      plan.input.empty() ? find.source_without_column(inputs, plan.states_clock) : plan.input.front().source;
  plan.truth = find.numbers(options.truth, states_first);
  if (!options.weight.empty()) plan.weight = {find.number(options.weight, states_first)};
  if (!options.label.empty()) {
    plan.label = options.label;
    plan.label_source = find.source_with(options.label, states_first);
  }
  plan_times(plan, find, options);
  // A sample without time has no place, and one without weight should not be guessed at.
  for (SourcePlan& source : plan.sources)
    source.request.may_miss.assign(source.request.numbers.size(), options.missing != Missing::error);
  for (const ColumnRef weight : plan.weight) plan.sources[weight.source].request.may_miss[weight.column] = false;
  plan.states = find.channels(plan.state);
  plan.inputs = find.channels(plan.input);
}

ColumnNames without_left_out(const ColumnNames& names, const DataOptions& options) {
  const std::vector<std::optional<Role>> roles = assign_roles(names, options.train, options.test);
  ColumnNames kept;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (roles[i]) kept.push_back(names[i]);
  return kept;
}

}  // namespace

std::vector<FilePlan> plan_import(const DataOptions& options) {
  check_options(options);
  const FilePattern inputs("data.inputs", options.root, options.inputs);
  ColumnNames names = inputs.runs();
  if (options.run.empty() && options.split.kind == SplitKind::none) names = without_left_out(names, options);
  std::vector<FilePlan> plans;
  for (const std::string& name : names) {
    FilePlan& plan = plans.emplace_back();
    plan.name = name;
    plan.starred = inputs.has_star();
    plan.paths.push_back(inputs.path_of(name));
  }
  if (!options.states.empty()) {
    const auto partners = find_partners(inputs, {"data.states", options.root, options.states}, names);
    for (std::size_t i = 0; i < plans.size(); ++i) plans[i].paths.push_back(partners[i]);
  }
  for (FilePlan& plan : plans) plan_columns(plan, options);
  return plans;
}

}  // namespace modebank
