#include "io/import/import_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "ident/base/nearest_name.hpp"
#include "io/import/file_patterns.hpp"
#include "io/import/run_roles.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using ColumnNames = std::vector<std::string>;

bool contains(const ColumnNames& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

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
  if (options.time.empty()) throw ConfigurationError("data.time is not set: name the column of seconds");
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

/// Looks columns up in the headers of one plan's files and notes them in its requests.
class ColumnFinder {
 public:
  explicit ColumnFinder(FilePlan& plan) : plan_(plan) {
    for (const auto& path : plan.paths) headers_.push_back(open_table(path)->columns());
    plan.requests.resize(plan.paths.size());
  }

  /// The first of `files` that has the column.
  ColumnRef number(const std::string& column, const std::vector<std::size_t>& files) {
    const std::size_t file = file_of(column, files);
    ColumnNames& requested = plan_.requests[file].numbers;
    const auto found = std::find(requested.begin(), requested.end(), column);
    const auto position = static_cast<std::size_t>(found - requested.begin());
    if (found == requested.end()) requested.push_back(column);
    return {file, position};
  }

  std::vector<ColumnRef> numbers(const ColumnNames& columns, const std::vector<std::size_t>& files) {
    std::vector<ColumnRef> found;
    for (const std::string& column : columns) found.push_back(number(column, files));
    return found;
  }

  std::size_t text(const std::string& column, const std::vector<std::size_t>& files) {
    if (column.empty()) return 0;
    const std::size_t file = file_of(column, files);
    plan_.requests[file].text = column;
    return file;
  }

 private:
  std::size_t file_of(const std::string& column, const std::vector<std::size_t>& files) const {
    for (const std::size_t file : files)
      if (files.size() == 1 || contains(headers_[file], column)) {
        column_position(plan_.paths[file].string(), headers_[file], column);  // throws unless it is there once
        return file;
      }
    ColumnNames all;
    std::string listing;
    for (const std::size_t file : files) {
      listing += fmt::format("; {} has {}", plan_.paths[file].string(), fmt::join(headers_[file], ", "));
      all.insert(all.end(), headers_[file].begin(), headers_[file].end());
    }
    throw ConfigurationError(fmt::format("no column \"{}\"{}{}", column, did_you_mean(column, all), listing));
  }

  FilePlan& plan_;
  std::vector<ColumnNames> headers_;
};

void plan_columns(FilePlan& plan, const DataOptions& options) {
  ColumnFinder find(plan);
  const std::size_t inputs = 0, states = plan.paths.size() - 1;
  const std::vector<std::size_t> states_first = states == inputs ? std::vector{inputs} : std::vector{states, inputs};
  plan.state = find.numbers(options.state, {states});
  plan.input = find.numbers(options.input, {inputs});
  plan.truth = find.numbers(options.truth, states_first);
  if (!options.weight.empty()) plan.weight = {find.number(options.weight, states_first)};
  if (options.join == Join::row || states == inputs) {
    plan.inputs_time = plan.states_time = find.number(options.time, states_first);
    plan.inputs_runs = plan.states_runs = find.text(options.run, states_first);
  } else {
    plan.inputs_time = find.number(options.time, {inputs});
    plan.states_time = find.number(options.time, {states});
    plan.inputs_runs = find.text(options.run, {inputs});
    plan.states_runs = find.text(options.run, {states});
  }
  // A sample without time has no place, and one without weight should not be guessed at.
  for (TableRequest& request : plan.requests)
    request.may_miss.assign(request.numbers.size(), options.missing != Missing::error);
  for (const ColumnRef time : {plan.inputs_time, plan.states_time})
    plan.requests[time.file].may_miss[time.column] = false;
  for (const ColumnRef weight : plan.weight) plan.requests[weight.file].may_miss[weight.column] = false;
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
  if (options.run.empty()) names = without_left_out(names, options);
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
