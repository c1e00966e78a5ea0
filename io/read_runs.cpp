#include "io/read_runs.hpp"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "ident/error.hpp"
#include "io/join_streams.hpp"
#include "io/missing_values.hpp"
#include "io/read_file.hpp"
#include "io/sha256.hpp"

namespace modebank {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Rows = std::vector<std::size_t>;
using RunRows = std::map<std::string, Rows>;  // sorted by run name, byte order

std::vector<CsvTable> read_tables(const FilePlan& plan, FileContent& result) {
  std::vector<CsvTable> tables(plan.paths.size());
  for (std::size_t f = 0; f < plan.paths.size(); ++f) {
    const std::string path = plan.paths[f].string();
    const std::string content = read_file(path);
    std::string sha256;
    tbb::parallel_invoke([&] { sha256 = sha256_hex(content); },
                         [&] { tables[f] = parse_csv(path, content, plan.requests[f]); });
    result.files.push_back({path, content.size(), std::move(sha256)});
    if (tables[f].rows() == 0) throw DataError(fmt::format("{}: a header, but no rows", path));
  }
  return tables;
}

/// One file's view of the runs: which rows belong to which, and the rows' times.
class RowReader {
 public:
  RowReader(const FilePlan& plan, const std::vector<CsvTable>& tables) : plan_(plan), tables_(tables) {}

  RunRows rows_by_run(std::size_t file, bool has_run_column) const {
    const CsvTable& table = tables_[file];
    RunRows runs;
    if (!has_run_column) {
      runs[""].resize(table.rows());
      std::iota(runs[""].begin(), runs[""].end(), std::size_t{0});
      return runs;
    }
    for (std::size_t row = 0; row < table.rows(); ++row) {
      if (table.text[row].empty())
        throw DataError(fmt::format("{}: column {}: missing value", place(file, row), plan_.requests[file].text));
      runs[table.text[row]].push_back(row);
    }
    return runs;
  }

  /// The rows in order of time; of those that share a time the first in the file.
  Rows in_order(ColumnRef time, Rows rows) const {
    const std::vector<double>& time_s = tables_[time.file].numbers[time.column];
    std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) { return time_s[a] < time_s[b]; });
    rows.erase(
        std::unique(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) { return time_s[a] == time_s[b]; }),
        rows.end());
    return rows;
  }

  VectorXd times(ColumnRef time, const Rows& rows) const {
    VectorXd time_s = column(time, rows);
    for (Index k = 1; k < time_s.size(); ++k)
      if (!(time_s(k) > time_s(k - 1)))
        throw DataError(fmt::format("{}: column {}: {} after {}: time going backwards or repeated",
                                    place(time.file, rows[k]), plan_.requests[time.file].numbers[time.column],
                                    time_s(k), time_s(k - 1)));
    return time_s;
  }

  MatrixXd columns(const std::vector<ColumnRef>& refs, const Rows& rows) const {
    MatrixXd values(static_cast<Index>(refs.size()), static_cast<Index>(rows.size()));
    for (std::size_t i = 0; i < refs.size(); ++i) values.row(static_cast<Index>(i)) = column(refs[i], rows).transpose();
    return values;
  }

 private:
  VectorXd column(ColumnRef ref, const Rows& rows) const {
    const std::vector<double>& all = tables_[ref.file].numbers[ref.column];
    VectorXd values(static_cast<Index>(rows.size()));
    for (std::size_t k = 0; k < rows.size(); ++k) values(static_cast<Index>(k)) = all[rows[k]];
    return values;
  }

  std::string place(std::size_t file, std::size_t row) const {
    return fmt::format("{}:{}", plan_.paths[file].string(), tables_[file].line[row]);
  }

  const FilePlan& plan_;
  const std::vector<CsvTable>& tables_;
};

void check_row_counts(const FilePlan& plan, const std::vector<CsvTable>& tables) {
  if (!plan.rows_correspond() || tables.front().rows() == tables.back().rows()) return;
  throw DataError(fmt::format("data.join = row: {} has {} rows, but {} has {}", plan.paths.front().string(),
                              tables.front().rows(), plan.paths.back().string(), tables.back().rows()));
}

void check_same_runs(const FilePlan& plan, const RunRows& inputs, const RunRows& states) {
  const auto require = [](const RunRows& here, const RunRows& there, const std::string& file,
                          const std::string& other) {
    for (const auto& [name, rows] : here)
      if (there.count(name) == 0) throw DataError(fmt::format("run \"{}\" is in {}, but not in {}", name, file, other));
  };
  require(inputs, states, plan.paths.front().string(), plan.paths.back().string());
  require(states, inputs, plan.paths.back().string(), plan.paths.front().string());
}

std::string span(const VectorXd& time_s) { return fmt::format("{} to {} s", time_s(0), time_s(time_s.size() - 1)); }

void check_samples(const FilePlan& plan, const std::string& run, Index samples, const Stream& states,
                   const Stream& inputs, const DataOptions& options) {
  if (samples >= 2) return;
  const std::string lag = options.lag_s == 0.0 ? "" : fmt::format(", lag {} s", options.lag_s);
  throw DataError(fmt::format(
      "run \"{}\" has {} sample{}, but needs at least two: states {} ({}), inputs {} ({}){}{}", run, samples,
      samples == 1 ? "" : "s", span(states.time_s), plan.paths[plan.states_time.file].string(), span(inputs.time_s),
      plan.paths[plan.inputs_time.file].string(), lag, samples == 0 ? ": the streams do not overlap" : ""));
}

std::string run_name(const FilePlan& plan, const std::string& value, const DataOptions& options) {
  if (options.run.empty()) return plan.name;
  return plan.starred ? plan.name + "_" + value : value;
}

Trajectory join(const FilePlan& plan, const RowReader& reader, const std::string& name, Rows states_rows,
                Rows inputs_rows, const DataOptions& options) {
  if (options.disorder == Disorder::sort) {
    states_rows = reader.in_order(plan.states_time, std::move(states_rows));
    inputs_rows = reader.in_order(plan.inputs_time, std::move(inputs_rows));
  }
  const Stream states{reader.times(plan.states_time, states_rows), reader.columns(plan.state, states_rows)};
  const Stream inputs{reader.times(plan.inputs_time, inputs_rows), reader.columns(plan.input, inputs_rows)};
  Trajectory run;
  run.run = name;
  run.lag_s = options.lag_s;
  run.time_s = joint_times(states.time_s, inputs.time_s, {options.rate_hz, options.lag_s});
  check_samples(plan, name, run.time_s.size(), states, inputs, options);
  run.state = interpolate(states, run.time_s);
  blank_gaps(states.time_s, run.time_s, run.state);
  run.input = hold(inputs, run.time_s.array() - options.lag_s);
  run.truth.resize(static_cast<Index>(plan.truth.size()), plan.truth.empty() ? 0 : run.time_s.size());
  for (std::size_t i = 0; i < plan.truth.size(); ++i) {
    const bool with_states = plan.rows_correspond() || plan.truth[i].file == plan.states_time.file;
    const Stream truth{with_states ? states.time_s : inputs.time_s,
                       reader.columns({plan.truth[i]}, with_states ? states_rows : inputs_rows)};
    run.truth.row(static_cast<Index>(i)) = interpolate(truth, run.time_s);
  }
  return run;
}

}  // namespace

FileContent read_runs(const FilePlan& plan, const DataOptions& options) {
  FileContent result;
  const std::vector<CsvTable> tables = read_tables(plan, result);
  check_row_counts(plan, tables);
  const RowReader reader(plan, tables);
  const bool has_run_column = !options.run.empty();
  const RunRows inputs = reader.rows_by_run(plan.rows_correspond() ? plan.inputs_runs : 0, has_run_column);
  const RunRows states = plan.rows_correspond() ? inputs : reader.rows_by_run(plan.paths.size() - 1, has_run_column);
  check_same_runs(plan, inputs, states);
  for (const auto& [value, inputs_rows] : inputs)
    result.runs.push_back(join(plan, reader, run_name(plan, value, options), states.at(value), inputs_rows, options));
  return result;
}

}  // namespace modebank
