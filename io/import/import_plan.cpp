#include "io/import/import_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "io/import/column_finder.hpp"
#include "io/import/file_patterns.hpp"
#include "io/import/open_table.hpp"
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
  if (options.state.empty()) throw ConfigurationError("data.state is not set; name the state columns, for example wz");
  if (options.time.empty() && options.rate_hz == 0.0)
    throw ConfigurationError(
        "data.time is not set; name the column of times, or set data.rate_hz for rows without times");
  if (options.time.size() > 2)
    throw ConfigurationError("data.time names more than two columns; name one, or seconds and nanoseconds");
  check_names("state", options.state);
  check_names("input", options.input);
  check_names("truth", options.truth);
  if (!options.truth.empty() && options.truth.size() != options.state.size())
    throw ConfigurationError(fmt::format("data.truth names {} columns, but data.state {}; name one per state, or none",
                                         options.truth.size(), options.state.size()));
  if (!(options.rate_hz >= 0.0 && options.rate_hz <= highest_rate_hz))
    throw ConfigurationError(fmt::format("data.rate_hz = {}: must be 0 to {}", options.rate_hz, highest_rate_hz));
  if (!std::isfinite(options.lag_s))
    throw ConfigurationError(fmt::format("data.lag_s = {}: must be finite", options.lag_s));
  if (options.lag_auto && options.input.empty())
    throw ConfigurationError("data.lag_s = auto needs inputs; name them in data.input");
}

/// Requests the times of all sources. If the sources' rows correspond, one source is enough, namely the first with a
/// time column.
void plan_times(FilePlan& plan, ColumnFinder& find, const DataOptions& options) {
  if (options.join == Join::time) {
    for (std::size_t source = 0; source < plan.sources.size(); ++source) {
      find.time(source, options);
      if (!options.run.empty()) plan.sources[source].run = find.text(source, options.run);
    }
    return;
  }
  const std::size_t timed = find.first_with_time({plan.states_clock, plan.inputs_clock}, options);
  find.time(timed, options);
  if (!options.run.empty()) {
    plan.runs_source = find.first_with(options.run, {plan.states_clock, plan.inputs_clock});
    plan.sources[plan.runs_source].run = find.text(plan.runs_source, options.run);
  }
  plan.states_clock = plan.inputs_clock = timed;
  plan.by_row = true;
}

void plan_columns(FilePlan& plan, const DataOptions& options, const std::shared_ptr<const DerivedChannels>& derived) {
  ColumnFinder find(plan, derived);
  const std::size_t inputs = 0, states = plan.paths.size() - 1;
  const std::vector<std::size_t> states_first = states == inputs ? std::vector{inputs} : std::vector{states, inputs};
  plan.state = find.numbers(options.state, {states});
  plan.input = find.numbers(options.input, {inputs});
  plan.states_clock = find.clock_of(plan.state.front());
  plan.inputs_clock =
      plan.input.empty() ? find.source_without_column(inputs, plan.states_clock) : find.clock_of(plan.input.front());
  plan.truth = find.numbers(options.truth, states_first);
  if (!options.where.empty()) plan.where = {find.where(states_first)};
  const std::optional<std::size_t> labels =
      options.label.empty() ? std::nullopt : std::optional(find.source_with(options.label, states_first));
  plan_times(plan, find, options);
  if (labels) plan.label = {*labels, find.text(*labels, options.label)};
  // A sample without a time has no position.
  for (SourcePlan& source : plan.sources)
    source.request.may_miss.assign(source.request.numbers.size(), options.missing != Missing::error);
  for (const ColumnRef where : plan.where)
    if (where.source != joint_source) plan.sources[where.source].request.may_miss[where.column] = true;
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

ColumnNames with_roles(const ColumnNames& names, const DataOptions& options) {
  const bool runs_are_files = options.run.empty() && options.split.kind == SplitKind::none;
  return runs_are_files ? without_left_out(names, options) : names;
}

FormatOptions format_of(const DataOptions& options) {
  FormatOptions format = options.format;
  if (!format.definitions.empty())
    format.definitions = (std::filesystem::path(options.root) / format.definitions).string();
  return format;
}

std::vector<FilePlan> plan_files(const DataOptions& options) {
  if (options.inputs == frames_in_memory)
    throw ConfigurationError(
        fmt::format("data.inputs = {}: these runs came from a program and are in no file; call modebank.run with the "
                    "same frames again, or name files",
                    frames_in_memory));
  const RunFiles inputs("data.inputs", options.root, options.inputs);
  const std::vector<RunFiles::File> files = inputs.files();
  ColumnNames names;
  for (const RunFiles::File& file : files) names.push_back(file.run);
  names = with_roles(names, options);
  std::vector<FilePlan> plans;
  const auto add = [&](FilePlan& plan, const RunFiles::File& file) {
    plan.paths.push_back(file.path);
    plan.readers.push_back(open_table(file.path, format_of(options)));
  };
  for (const RunFiles::File& file : files) {
    if (std::find(names.begin(), names.end(), file.run) == names.end()) continue;
    FilePlan& plan = plans.emplace_back();
    plan.name = file.run;
    plan.starred = !inputs.one();
    add(plan, file);
  }
  if (options.states.empty()) return plans;
  const std::vector<RunFiles::File> partners =
      RunFiles("data.states", options.root, options.states).partners(inputs, names);
  for (std::size_t i = 0; i < plans.size(); ++i) add(plans[i], partners[i]);
  return plans;
}

std::vector<FilePlan> plan_memory(const DataOptions& options, const MemoryTables& memory) {
  ColumnNames names;
  for (const auto& [name, tables] : memory) names.push_back(name);
  std::vector<FilePlan> plans;
  for (const std::string& name : with_roles(names, options)) {
    FilePlan& plan = plans.emplace_back();
    plan.name = name;
    plan.starred = memory.size() > 1;
    plan.readers = memory.at(name);
    plan.paths.emplace_back(name);
    if (plan.readers.size() > 1) plan.paths.emplace_back(name + " (states)");
  }
  return plans;
}

}  // namespace

FilePlan::FileRequests FilePlan::requests_of(std::size_t path) const {
  FileRequests result;
  for (std::size_t source = 0; source < sources.size(); ++source)
    if (sources[source].path == path) {
      result.sources.push_back(source);
      result.requests.push_back(columns_to_read(sources[source].request, sources[source].derived));
    }
  return result;
}

std::vector<FilePlan> plan_import(const DataOptions& options, const MemoryTables* memory) {
  check_options(options);
  std::vector<FilePlan> plans = memory ? plan_memory(options, *memory) : plan_files(options);
  const auto derived = std::make_shared<const DerivedChannels>(options);
  for (FilePlan& plan : plans) plan_columns(plan, options, derived);
  return plans;
}

}  // namespace modebank
