#include "io/import/read_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include "ident/base/not_a_number.hpp"
#include "io/import/bring.hpp"
#include "io/import/stamp_check.hpp"
#include "io/table/stamp.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Eigen::VectorXd;
using Rows = std::vector<std::size_t>;
using RunRows = std::map<std::string, Rows>;  // sorted by run name, byte order

constexpr std::int64_t large_origin_ns = 100'000'000'000'000'000;  // three years: smaller ones cost no precision

/// One table per source of the plan, and one more of labels if there are any.
std::vector<Table> read_tables(const FilePlan& plan, FileContent& result) {
  std::vector<Table> tables(plan.sources.size() + (plan.label.empty() ? 0 : 1));
  for (std::size_t path = 0; path < plan.paths.size(); ++path) {
    std::vector<std::size_t> here;
    std::vector<TableRequest> requests;
    for (std::size_t source = 0; source < plan.sources.size(); ++source)
      if (plan.sources[source].path == path) {
        here.push_back(source);
        requests.push_back(plan.sources[source].request);
      }
    if (!plan.label.empty() && plan.sources[plan.label_source].path == path) {
      here.push_back(plan.sources.size());
      requests.push_back({plan.sources[plan.label_source].request.table, {}, plan.label});
    }
    std::vector<Table> read = plan.readers[path]->read(requests, result.files.emplace_back());
    for (std::size_t i = 0; i < here.size(); ++i) {
      if (read[i].rows() == 0) throw DataError(fmt::format("{}: a header, but no rows", plan.paths[path].string()));
      result.notes.insert(result.notes.end(), read[i].notes.begin(), read[i].notes.end());
      tables[here[i]] = std::move(read[i]);
    }
  }
  return tables;
}

/// The rows of one run, per source, and what its times count from.
struct RunSlice {
  std::vector<Rows> rows;
  std::int64_t origin_ns = 0;
};

/// Tables' view of the runs: which rows belong to which, and their values.
class RowReader {
 public:
  RowReader(const FilePlan& plan, const std::vector<Table>& tables, const DataOptions& options)
      : plan_(plan), tables_(tables), options_(options) {}

  RunRows rows_by_run(std::size_t source) const {
    const Table& table = tables_[source];
    RunRows runs;
    if (options_.run.empty()) {
      runs[""].resize(table.rows());
      std::iota(runs[""].begin(), runs[""].end(), std::size_t{0});
      return runs;
    }
    for (std::size_t row = 0; row < table.rows(); ++row) {
      if (table.text[row].empty())
        throw DataError(
            fmt::format("{}: column {}: missing value", place(source, row), plan_.sources[source].request.text));
      runs[table.text[row]].push_back(row);
    }
    return runs;
  }

  /// What the run's times count from: nothing, or its first sample where that is long after.
  std::int64_t origin_ns(const std::vector<Rows>& rows) const {
    std::int64_t first = std::numeric_limits<std::int64_t>::max();
    for (std::size_t source = 0; source < plan_.sources.size(); ++source)
      if (const auto& stamps = tables_[source].time_ns; !stamps.empty())
        for (const std::size_t row : rows[source])
          if (stamps[row] != missing_stamp) first = std::min(first, stamps[row]);
    return first == std::numeric_limits<std::int64_t>::max() || std::abs(first) < large_origin_ns ? 0 : first;
  }

  /// The samples of `clock`, with the columns `refs` of whatever source; those of others are brought to its times.
  FileStream stream(std::size_t clock, const std::vector<ColumnRef>& refs, const RunSlice& run, Bring bring) const {
    FileStream result = own_stream(clock, refs, run);
    if (plan_.rows_correspond()) return result;
    std::vector<std::size_t> others;
    for (const ColumnRef ref : refs)
      if (ref.source != clock && std::find(others.begin(), others.end(), ref.source) == others.end())
        others.push_back(ref.source);
    if (others.empty()) return result;
    put_in_order(result, options_.disorder);
    for (const std::size_t other : others) {
      FileStream source = own_stream(other, refs, run);
      put_in_order(source, options_.disorder);
      std::vector<Index> theirs;
      for (std::size_t i = 0; i < refs.size(); ++i)
        if (refs[i].source == other) theirs.push_back(static_cast<Index>(i));
      bring_to(result, source, theirs, bring);
    }
    return result;
  }

  /// Throws DataError for stamps of the run that are out by orders of magnitude.
  void check_stamps(const RunSlice& run) const {
    for (std::size_t source = 0; source < plan_.sources.size(); ++source) {
      const auto& all = tables_[source].time_ns;
      Rows rows;
      std::vector<std::int64_t> stamps;
      for (const std::size_t row : all.empty() ? Rows() : run.rows[source]) {
        if (all[row] == missing_stamp) continue;
        rows.push_back(row);
        stamps.push_back(all[row]);
      }
      const std::optional<std::size_t> out = stamp_far_out(stamps);
      if (!out) continue;
      const std::size_t other = *out == 0 ? 1 : *out - 1;
      throw DataError(fmt::format("{}: column {}: {} s {} {} s: a stamp out by orders of magnitude",
                                  place(source, rows[*out]), plan_.sources[source].request.time.column,
                                  seconds_text(stamps[*out]), *out == 0 ? "before" : "after",
                                  seconds_text(stamps[other])));
    }
  }

  /// What is known of the run, at the times of the table that says it.
  LabelStream labels(const RunSlice& run) const {
    if (plan_.label.empty()) return {};
    const std::size_t clock = plan_.rows_correspond() ? plan_.states_clock : plan_.label_source;
    LabelStream result{times(clock, run), {}};
    for (const std::size_t row : run.rows[clock]) result.text.push_back(tables_.back().text[row]);
    return result;
  }

  /// Weights, none negative.
  void check_weights(ColumnRef ref, const Rows& rows) const {
    for (const std::size_t row : rows)
      if (const double value = tables_[ref.source].numbers[ref.column][row]; value < 0.0)
        throw DataError(
            fmt::format("{}: column {}: {} is negative: a weight is at least 0, and 0 leaves the sample's "
                        "transition out",
                        place(ref.source, row), plan_.sources[ref.source].request.numbers[ref.column], value));
  }

 private:
  std::string place(std::size_t source, std::size_t row) const {
    return fmt::format("{}:{}", plan_.paths[plan_.sources[source].path].string(), tables_[source].line[row]);
  }

  VectorXd times(std::size_t source, const RunSlice& run) const {
    const Table& table = tables_[source];
    const Rows& rows = run.rows[source];
    VectorXd time_s(static_cast<Index>(rows.size()));
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const auto at = static_cast<Index>(k);
      if (table.time_ns.empty())
        time_s(at) = static_cast<double>(k) / options_.rate_hz;
      else if (table.time_ns[rows[k]] == missing_stamp)
        time_s(at) = not_a_number;
      else if (run.origin_ns == 0 && !table.time_s.empty())
        time_s(at) = table.time_s[rows[k]];
      else
        time_s(at) = static_cast<double>(table.time_ns[rows[k]] - run.origin_ns) / 1e9;
    }
    return time_s;
  }

  /// Times of a source and those of the columns that are its own; the others stay empty rows. Where rows correspond all
  /// are its own.
  FileStream own_stream(std::size_t clock, const std::vector<ColumnRef>& refs, const RunSlice& run) const {
    FileStream result;
    result.stream.time_s = times(clock, run);
    result.stream.values.setConstant(static_cast<Index>(refs.size()), result.stream.time_s.size(), not_a_number);
    for (std::size_t i = 0; i < refs.size(); ++i)
      if (refs[i].source == clock || plan_.rows_correspond())
        result.stream.values.row(static_cast<Index>(i)) = column(refs[i], run.rows[clock]).transpose();
    for (const std::size_t row : run.rows[clock]) result.line.push_back(tables_[clock].line[row]);
    result.file = plan_.paths[plan_.sources[clock].path].string();
    result.time_column = plan_.sources[clock].request.time.column;
    result.origin_ns = run.origin_ns;
    return result;
  }

  VectorXd column(ColumnRef ref, const Rows& rows) const {
    const std::vector<double>& all = tables_[ref.source].numbers[ref.column];
    VectorXd values(static_cast<Index>(rows.size()));
    for (std::size_t k = 0; k < rows.size(); ++k) values(static_cast<Index>(k)) = all[rows[k]];
    return values;
  }

  const FilePlan& plan_;
  const std::vector<Table>& tables_;
  const DataOptions& options_;
};

void check_row_counts(const FilePlan& plan, const std::vector<Table>& tables) {
  if (!plan.rows_correspond()) return;
  const auto name = [&](std::size_t source) { return plan.paths[plan.sources[source].path].string(); };
  std::size_t first = 0;  // the inputs' file comes first
  for (std::size_t source = 0; source < plan.sources.size(); ++source)
    if (plan.sources[source].path < plan.sources[first].path) first = source;
  for (std::size_t source = 0; source < plan.sources.size(); ++source)
    if (tables[source].rows() != tables[first].rows())
      throw DataError(fmt::format("data.join = row: {} has {} rows, but {} has {}", name(first), tables[first].rows(),
                                  name(source), tables[source].rows()));
}

/// The rows of every run in every source.
std::map<std::string, RunSlice> slices_of(const FilePlan& plan, const RowReader& reader) {
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
    slice.origin_ns = reader.origin_ns(slice.rows);
    reader.check_stamps(slice);
  }
  return slices;
}

std::string run_name(const FilePlan& plan, const std::string& value, const DataOptions& options) {
  if (options.run.empty()) return plan.name;
  return plan.starred ? plan.name + "_" + value : value;
}

/// States, or inputs, with the companions that are sampled with them as further rows.
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
  run.weight.resize(plan.weight.size());
  Gathered states{plan.state, {}}, inputs{plan.input, {}};
  const auto gather = [&](const std::vector<ColumnRef>& refs, std::vector<RunStreams::Companion>& companions) {
    for (std::size_t i = 0; i < refs.size(); ++i) {
      companions[i].with_states = plan.rows_correspond() || refs[i].source != plan.inputs_clock;
      Gathered& with = companions[i].with_states ? states : inputs;
      with.refs.push_back(refs[i]);
      with.companions.push_back(&companions[i]);
    }
  };
  for (const ColumnRef ref : plan.weight) reader.check_weights(ref, slice.rows[ref.source]);
  run.label = reader.labels(slice);
  gather(plan.truth, run.truth);
  gather(plan.weight, run.weight);
  run.states = states.split(reader.stream(plan.states_clock, states.refs, slice, Bring::interpolated));
  run.inputs = inputs.split(reader.stream(plan.inputs_clock, inputs.refs, slice, Bring::held));
  return run;
}

}  // namespace

FileContent read_runs(const FilePlan& plan, const DataOptions& options) {
  FileContent result;
  result.notes = plan.notes;
  const std::vector<Table> tables = read_tables(plan, result);
  check_row_counts(plan, tables);
  const RowReader reader(plan, tables, options);
  for (const auto& [value, slice] : slices_of(plan, reader))
    result.runs.push_back(streams_of(plan, reader, run_name(plan, value, options), slice));
  return result;
}

}  // namespace modebank
