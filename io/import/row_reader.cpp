#include "io/import/row_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

#include "ident/base/not_a_number.hpp"
#include "io/import/stamp_check.hpp"
#include "io/table/stamp.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

constexpr std::int64_t large_origin_ns = 100'000'000'000'000'000;  // three years; times that start earlier than this
                                                                   // lose no precision

bool is_same(ColumnRef a, ColumnRef b) { return a.source == b.source && a.column == b.column; }

}  // namespace

using Eigen::VectorXd;

RunRows RowReader::rows_by_run(std::size_t source) const {
  const Table& table = tables_[source];
  RunRows runs;
  const SourcePlan& plan = plan_.sources[source];
  if (!plan.run) {
    runs[""].resize(table.rows());
    std::iota(runs[""].begin(), runs[""].end(), std::size_t{0});
    return runs;
  }
  const std::vector<std::string>& names = table.texts[*plan.run];
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (names[row].empty())
      throw DataError(fmt::format("{}: column {}: missing value", place(source, row), plan.request.texts[*plan.run]));
    runs[names[row]].push_back(row);
  }
  return runs;
}

std::int64_t RowReader::origin_ns(const std::vector<Rows>& rows) const {
  std::int64_t first = std::numeric_limits<std::int64_t>::max();
  for (std::size_t source = 0; source < plan_.sources.size(); ++source)
    if (const auto& stamps = tables_[source].time_ns; !stamps.empty())
      for (const std::size_t row : rows[source])
        if (stamps[row] != missing_stamp) first = std::min(first, stamps[row]);
  const bool is_small = first > -large_origin_ns && first < large_origin_ns;
  return first == std::numeric_limits<std::int64_t>::max() || is_small ? 0 : first;
}

FileStream RowReader::stream(std::size_t clock, const std::vector<ColumnRef>& refs, const RunSlice& run,
                             Bring bring) const {
  std::vector<ColumnRef> read;
  for (const ColumnRef ref : refs) gather_columns(ref, read);
  if (read.size() == refs.size() && plan_.joint.empty()) return brought(clock, refs, run, bring);
  FileStream result = brought(clock, read, run, bring);
  const Stream& from = result.stream;
  Eigen::MatrixXd values(static_cast<Index>(refs.size()), from.time_s.size());
  for (std::size_t i = 0; i < refs.size(); ++i)
    values.row(static_cast<Index>(i)) = derived(refs[i], read, from).transpose();
  result.stream.values = std::move(values);
  return result;
}

std::string UnsetRows::note() const {
  if (count == 0) return {};
  return fmt::format("{} row{} left out, stamped before the clock was set ({})", count, count == 1 ? " is" : "s are",
                     example);
}

UnsetRows RowReader::leave_out_unset(RunSlice& run) const {
  UnsetRows result;
  for (std::size_t source = 0; source < plan_.sources.size(); ++source) {
    const auto& all = tables_[source].time_ns;
    if (all.empty()) continue;
    std::vector<std::int64_t> stamps;
    for (const std::size_t row : run.rows[source]) stamps.push_back(all[row]);
    const std::size_t unset = rows_before_clock_was_set(stamps);
    if (unset == 0) continue;
    result.add({unset, fmt::format("{}: {} s, then {} s", place(source, run.rows[source][unset - 1]),
                                   seconds_text(stamps[unset - 1]), seconds_text(stamps[unset]))});
    for (std::size_t other = 0; other < plan_.sources.size(); ++other)
      if (other == source || plan_.rows_correspond())
        run.rows[other].erase(run.rows[other].begin(), run.rows[other].begin() + static_cast<std::ptrdiff_t>(unset));
  }
  return result;
}

void RowReader::check_stamps(const RunSlice& run) const {
  for (std::size_t source = 0; source < plan_.sources.size(); ++source) {
    const auto& all = tables_[source].time_ns;
    if (all.empty()) continue;
    Rows rows;
    std::vector<std::int64_t> stamps;
    for (const std::size_t row : run.rows[source]) {
      if (all[row] == missing_stamp) continue;
      rows.push_back(row);
      stamps.push_back(all[row]);
    }
    const std::optional<std::size_t> out = stamp_far_out(stamps);
    if (!out) continue;
    const std::size_t other = *out == 0 ? 1 : *out - 1;
    throw DataError(fmt::format("{}: column {}: {} s {} {} s; this stamp differs by orders of magnitude",
                                place(source, rows[*out]), plan_.sources[source].request.time.column,
                                seconds_text(stamps[*out]), *out == 0 ? "before" : "after",
                                seconds_text(stamps[other])));
  }
}

LabelStream RowReader::labels(const RunSlice& run) const {
  if (!plan_.label) return {};
  const std::size_t clock = plan_.rows_correspond() ? plan_.states_clock : plan_.label->source;
  LabelStream result{times(clock, run), {}};
  for (const std::size_t row : run.rows[clock])
    result.text.push_back(tables_[plan_.label->source].texts[plan_.label->column][row]);
  return result;
}

void RowReader::gather_columns(ColumnRef ref, std::vector<ColumnRef>& read) const {
  if (ref.source == joint_source)
    for (const ColumnRef operand : plan_.joint[ref.column].operands) gather_columns(operand, read);
  else if (std::none_of(read.begin(), read.end(), [&](ColumnRef known) { return is_same(known, ref); }))
    read.push_back(ref);
}

VectorXd RowReader::derived(ColumnRef ref, const std::vector<ColumnRef>& read, const Stream& from) const {
  if (ref.source != joint_source) {
    const auto at = std::find_if(read.begin(), read.end(), [&](ColumnRef known) { return is_same(known, ref); });
    return from.values.row(at - read.begin()).transpose();
  }
  const JointColumn& column = plan_.joint[ref.column];
  std::vector<VectorXd> operands;
  for (const ColumnRef operand : column.operands) operands.push_back(derived(operand, read, from));
  std::vector<std::span<const double>> views;
  for (const VectorXd& operand : operands) views.emplace_back(operand.data(), static_cast<std::size_t>(operand.size()));
  const std::vector<double> values =
      column.channel->expression.evaluate(views, {from.time_s.data(), static_cast<std::size_t>(from.time_s.size())});
  return VectorXd::Map(values.data(), std::ssize(values));
}

FileStream RowReader::brought(std::size_t clock, const std::vector<ColumnRef>& refs, const RunSlice& run,
                              Bring bring) const {
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

std::string RowReader::place(std::size_t source, std::size_t row) const {
  return fmt::format("{}:{}", plan_.paths[plan_.sources[source].path].string(), tables_[source].line[row]);
}

namespace {

/// Stamps may be so far apart that their difference overflows. This function accepts such stamps; import reports them
/// later.
double seconds_between(std::int64_t from_ns, std::int64_t to_ns) {
  constexpr double ns_per_s = 1e9;
  std::int64_t difference_ns = 0;
  const bool too_far = __builtin_sub_overflow(to_ns, from_ns, &difference_ns);
  return (too_far ? static_cast<double>(to_ns) - static_cast<double>(from_ns) : static_cast<double>(difference_ns)) /
         ns_per_s;
}

}  // namespace

VectorXd RowReader::times(std::size_t source, const RunSlice& run) const {
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
      time_s(at) = seconds_between(run.origin_ns, table.time_ns[rows[k]]);
  }
  return time_s;
}

FileStream RowReader::own_stream(std::size_t clock, const std::vector<ColumnRef>& refs, const RunSlice& run) const {
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
  result.unwritten = tables_[clock].unwritten;
  return result;
}

VectorXd RowReader::column(ColumnRef ref, const Rows& rows) const {
  const std::vector<double>& all = tables_[ref.source].numbers[ref.column];
  VectorXd values(static_cast<Index>(rows.size()));
  for (std::size_t k = 0; k < rows.size(); ++k) values(static_cast<Index>(k)) = all[rows[k]];
  return values;
}

}  // namespace modebank
