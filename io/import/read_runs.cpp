#include "io/import/read_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "io/import/stamp_check.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

/// Times of day in several tables are counted from the same midnight, even if midnight lies between their first rows.
void align_clocks(std::vector<Table>& tables) {
  constexpr std::int64_t day_ns = 86'400'000'000'000;
  std::optional<std::int64_t> reference;
  for (Table& table : tables) {
    const auto known = [](std::int64_t stamp) { return stamp != missing_stamp; };
    const auto first = std::find_if(table.time_ns.begin(), table.time_ns.end(), known);
    if (!table.form.clock || first == table.time_ns.end()) continue;
    if (!reference) reference = *first;
    const double apart = static_cast<double>(*reference - *first) / static_cast<double>(day_ns);
    const std::int64_t shift_ns = std::llround(apart) * day_ns;
    for (std::int64_t& stamp : table.time_ns) stamp += known(stamp) ? shift_ns : 0;
  }
}

/// Where a clock starts again, a run begins, as if a column of the table said so.
void begin_runs(SourcePlan& plan, Table& table, std::vector<std::string>& notes) {
  const std::vector<std::size_t> rows = clock_restarts({table.time_ns.begin(), table.time_ns.end()}, notes);
  if (rows.empty()) return;
  plan.run = table.texts.size();
  std::vector<std::string>& names = table.texts.emplace_back();
  for (std::size_t row = 0; row < table.rows(); ++row)
    names.push_back(fmt::to_string(1 + (std::ranges::upper_bound(rows, row) - rows.begin())));
}

/// The tables of the plan's sources, in order.
std::vector<Table> read_tables(FilePlan& plan, const DataOptions& options, FileContent& result) {
  std::vector<Table> tables(plan.sources.size());
  for (std::size_t path = 0; path < plan.paths.size(); ++path) {
    const auto [here, requests] = plan.requests_of(path);
    std::vector<Table> read = plan.readers[path]->read(requests, &result.files.emplace_back());
    for (std::size_t i = 0; i < here.size(); ++i) {
      if (read[i].rows() == 0)
        throw DataError(fmt::format("{}: there is a header, but no rows", plan.paths[path].string()));
      result.notes.insert(result.notes.end(), read[i].notes.begin(), read[i].notes.end());
      for (const auto& [word, count] : read[i].missing_words) result.missing_words[word] += count;
      if (!read[i].alternation.empty()) result.notes.push_back(read[i].alternation);
      const TimeRequest& time = requests[i].time;
      if (!time.column.empty()) result.forms.push_back({plan.paths[path].string(), time.column, path, read[i].form});
      tables[here[i]] = std::move(read[i]);
    }
  }
  align_clocks(tables);
  for (std::size_t source = 0; source < plan.sources.size(); ++source) {
    SourcePlan& of = plan.sources[source];
    if (options.run.empty()) begin_runs(of, tables[source], result.notes);
    const RowOrder order{tables[plan.states_clock], of.run, options.rate_hz};
    derive_columns(plan.paths[of.path].string(), of.request, of.derived, order, tables[source]);
  }
  return tables;
}

void check_row_counts(const FilePlan& plan, const std::vector<Table>& tables) {
  if (!plan.rows_correspond()) return;
  const auto name = [&](std::size_t source) { return plan.paths[plan.sources[source].path].string(); };
  std::size_t first = 0;  // the first path is the inputs file
  for (std::size_t source = 0; source < plan.sources.size(); ++source)
    if (plan.sources[source].path < plan.sources[first].path) first = source;
  for (std::size_t source = 0; source < plan.sources.size(); ++source)
    if (tables[source].rows() != tables[first].rows())
      throw DataError(fmt::format("data.join = row: {} has {} rows, but {} has {}", name(first), tables[first].rows(),
                                  name(source), tables[source].rows()));
}

/// The rows of every run in every source. Rows that were stamped before the clock was set are removed.
std::map<std::string, RunSlice> slices_of(const FilePlan& plan, const RowReader& reader, UnsetRows& unset) {
  std::vector<RunRows> by_source;
  for (std::size_t source = 0; source < plan.sources.size(); ++source)
    by_source.push_back(reader.rows_by_run(plan.rows_correspond() ? plan.runs_source : source));
  const auto file = [&](std::size_t source) { return plan.paths[plan.sources[source].path].string(); };
  const auto require = [&](std::size_t here, std::size_t there) {
    for (const auto& [name, rows] : by_source[here])
      if (by_source[there].count(name) == 0)
        throw DataError(fmt::format("run \"{}\" is in {}, but not in {}", name, file(here), file(there)));
  };
  const std::size_t first = plan.inputs_clock;
  for (std::size_t source = 0; source < plan.sources.size(); ++source) {
    require(first, source);
    require(source, first);
  }
  std::map<std::string, RunSlice> slices;
  for (const auto& [name, rows] : by_source[first]) {
    RunSlice& slice = slices[name];
    for (const RunRows& source : by_source) slice.rows.push_back(source.at(name));
    unset.add(reader.leave_out_unset(slice));
    slice.origin_ns = reader.origin_ns(slice.rows);
    reader.check_stamps(slice);
  }
  return slices;
}

/// Name of a run, made from its column's value. The slash of ROS 1 frame names, such as "/base", is removed.
std::string run_name(const FilePlan& plan, std::string value) {
  if (value.empty()) return plan.name;
  if (value.starts_with('/')) value.erase(0, 1);
  return plan.starred ? plan.name + "_" + value : value;
}

/// States or inputs. Their companions are further rows.
struct Gathered {
  std::vector<ColumnRef> refs;
  std::vector<RunStreams::Companion*> companions;

  FileStream split(FileStream all) const {
    const auto channels = static_cast<Index>(refs.size() - companions.size());
    for (std::size_t i = 0; i < companions.size(); ++i)
      companions[i]->values = all.stream.values.row(channels + static_cast<Index>(i)).transpose();
    all.stream.values.conservativeResize(channels, Eigen::NoChange);
    return all;
  }
};

RunStreams streams_of(const FilePlan& plan, const RowReader& reader, const std::string& name, const RunSlice& slice) {
  RunStreams run;
  run.run = name;
  run.truth.resize(plan.truth.size());
  run.where.resize(plan.where.size());
  Gathered states{plan.state, {}}, inputs{plan.input, {}};
  const auto gather = [&](const std::vector<ColumnRef>& refs, std::vector<RunStreams::Companion>& companions) {
    for (std::size_t i = 0; i < refs.size(); ++i) {
      companions[i].with_states = plan.states_clock == plan.inputs_clock || refs[i].source != plan.inputs_clock;
      Gathered& with = companions[i].with_states ? states : inputs;
      with.refs.push_back(refs[i]);
      with.companions.push_back(&companions[i]);
    }
  };
  run.label = reader.labels(slice);
  gather(plan.truth, run.truth);
  gather(plan.where, run.where);
  run.states = states.split(reader.stream(plan.states_clock, states.refs, slice, Bring::interpolated));
  run.inputs = inputs.split(reader.stream(plan.inputs_clock, inputs.refs, slice, Bring::held));
  for (RunStreams::Companion& where : run.where)
    where.values = where.values.unaryExpr([](double value) { return value == 0.0 || std::isnan(value) ? 0.0 : 1.0; });
  return run;
}

}  // namespace

void read_runs(FilePlan plan, const DataOptions& options, FileContent& result) {
  result.notes = plan.notes;
  const std::vector<Table> tables = read_tables(plan, options, result);
  check_row_counts(plan, tables);
  const RowReader reader(plan, tables, options);
  for (const auto& [value, slice] : slices_of(plan, reader, result.unset))
    result.runs.push_back(streams_of(plan, reader, run_name(plan, value), slice));
}

}  // namespace modebank
