#include "io/import/read_runs.hpp"

#include <fmt/format.h>

#include <map>
#include <numeric>

#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Eigen::VectorXd;
using Rows = std::vector<std::size_t>;
using RunRows = std::map<std::string, Rows>;  // sorted by run name, byte order

std::vector<Table> read_tables(const FilePlan& plan, FileContent& result) {
  std::vector<Table> tables(plan.paths.size());
  for (std::size_t f = 0; f < plan.paths.size(); ++f) {
    const std::string path = plan.paths[f].string();
    tables[f] = open_table(plan.paths[f])->read(plan.requests[f], result.files.emplace_back());
    if (tables[f].rows() == 0) throw DataError(fmt::format("{}: a header, but no rows", path));
  }
  return tables;
}

/// One file's view of the runs: which rows belong to which, and the rows' times.
class RowReader {
 public:
  RowReader(const FilePlan& plan, const std::vector<Table>& tables) : plan_(plan), tables_(tables) {}

  RunRows rows_by_run(std::size_t file, bool has_run_column) const {
    const Table& table = tables_[file];
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

  FileStream stream(ColumnRef time, const std::vector<ColumnRef>& refs, const Rows& rows) const {
    FileStream result;
    result.stream.time_s = column(time, rows);
    result.stream.values.resize(static_cast<Index>(refs.size()), static_cast<Index>(rows.size()));
    for (std::size_t i = 0; i < refs.size(); ++i)
      result.stream.values.row(static_cast<Index>(i)) = column(refs[i], rows).transpose();
    for (const std::size_t row : rows) result.line.push_back(tables_[time.file].line[row]);
    result.file = plan_.paths[time.file].string();
    result.time_column = plan_.requests[time.file].numbers[time.column];
    return result;
  }

  /// Weights, none negative.
  VectorXd weights(ColumnRef ref, const Rows& rows) const {
    const VectorXd values = column(ref, rows);
    for (Index k = 0; k < values.size(); ++k)
      if (values(k) < 0.0)
        throw DataError(
            fmt::format("{}: column {}: {} is negative: a weight is at least 0, and 0 leaves the sample's "
                        "transition out",
                        place(ref.file, rows[static_cast<std::size_t>(k)]),
                        plan_.requests[ref.file].numbers[ref.column], values(k)));
    return values;
  }

  VectorXd column(ColumnRef ref, const Rows& rows) const {
    const std::vector<double>& all = tables_[ref.file].numbers[ref.column];
    VectorXd values(static_cast<Index>(rows.size()));
    for (std::size_t k = 0; k < rows.size(); ++k) values(static_cast<Index>(k)) = all[rows[k]];
    return values;
  }

 private:
  std::string place(std::size_t file, std::size_t row) const {
    return fmt::format("{}:{}", plan_.paths[file].string(), tables_[file].line[row]);
  }

  const FilePlan& plan_;
  const std::vector<Table>& tables_;
};

void check_row_counts(const FilePlan& plan, const std::vector<Table>& tables) {
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

std::string run_name(const FilePlan& plan, const std::string& value, const DataOptions& options) {
  if (options.run.empty()) return plan.name;
  return plan.starred ? plan.name + "_" + value : value;
}

RunStreams streams_of(const FilePlan& plan, const RowReader& reader, const std::string& name, const Rows& states_rows,
                      const Rows& inputs_rows) {
  RunStreams run;
  run.run = name;
  run.states = reader.stream(plan.states_time, plan.state, states_rows);
  run.inputs = reader.stream(plan.inputs_time, plan.input, inputs_rows);
  for (const ColumnRef& truth : plan.truth) {
    const bool with_states = plan.rows_correspond() || truth.file == plan.states_time.file;
    run.truth.push_back({with_states, reader.column(truth, with_states ? states_rows : inputs_rows)});
  }
  for (const ColumnRef& ref : plan.weight) {
    const bool with_states = plan.rows_correspond() || ref.file == plan.states_time.file;
    run.weight.push_back({with_states, reader.weights(ref, with_states ? states_rows : inputs_rows)});
  }
  return run;
}

}  // namespace

FileContent read_runs(const FilePlan& plan, const DataOptions& options) {
  FileContent result;
  const std::vector<Table> tables = read_tables(plan, result);
  check_row_counts(plan, tables);
  const RowReader reader(plan, tables);
  const bool has_run_column = !options.run.empty();
  const RunRows inputs = reader.rows_by_run(plan.rows_correspond() ? plan.inputs_runs : 0, has_run_column);
  const RunRows states = plan.rows_correspond() ? inputs : reader.rows_by_run(plan.paths.size() - 1, has_run_column);
  check_same_runs(plan, inputs, states);
  for (const auto& [value, inputs_rows] : inputs)
    result.runs.push_back(streams_of(plan, reader, run_name(plan, value, options), states.at(value), inputs_rows));
  return result;
}

}  // namespace modebank
