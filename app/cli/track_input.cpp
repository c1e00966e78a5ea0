#include "app/cli/track_input.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "filter/step/gaussian.hpp"
#include "ident/base/characters.hpp"
#include "ident/base/not_a_number.hpp"
#include "io/csv/csv_text.hpp"
#include "io/table/number.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// Removes the reader's line number from a message, because it counts from the start of the batch and not of the input.
std::string without_place(std::string message) {
  const std::string place = "standard input:";
  if (!message.starts_with(place)) return message;
  std::size_t end = place.size();
  while (end < message.size() && is_digit(message[end])) ++end;
  return message.compare(end, 2, ": ") == 0 ? message.substr(end + 2) : message;
}

}  // namespace

SampleReader::SampleReader(const DataOptions& data) : data_(data), table_(data) {
  sample_.input.setZero(std::ssize(data.input));
  sample_.measurement.setConstant(std::ssize(data.state), not_a_number);
  next_ = sample_;
}

SampleReader::Line SampleReader::malformed(std::string reason) {
  reason_ = without_place(std::move(reason));
  return Line::malformed;
}

void SampleReader::read(std::span<const std::string> lines, const Take& take) {
  std::size_t first = 0;  // of the rows that have not been read
  for (std::size_t i = 0; i <= lines.size(); ++i) {
    const bool blank = i < lines.size() && (without_blanks(lines[i]).empty() ||
                                            (table_.has_rows() && !table_.has_objects() && is_comment(lines[i])));
    if (i < lines.size() && !blank && table_.has_rows()) continue;
    read_rows(lines.subspan(first, i - first), first, take);
    first = i + 1;
    if (blank)
      take(i, Line::blank);
    else if (i < lines.size())
      read_head(lines[i], i, take);
  }
}

void SampleReader::read_head(std::string line, std::size_t position, const Take& take) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (line.starts_with(byte_order_mark)) line.erase(0, byte_order_mark.size());
  bool is_row = table_.is_open();
  try {
    if (!is_row) is_row = table_.open(line);
  } catch (const DataError& error) {
    return take(position, malformed(error.what()));
  }
  if (is_row)
    read_rows({&line, 1}, position, take);
  else
    take(position, table_.is_open() ? Line::header : Line::blank);
}

/// One malformed line makes the whole batch fail. The batch is then halved until the malformed line is alone.
void SampleReader::read_rows(std::span<const std::string> lines, std::size_t position, const Take& take) {
  if (lines.empty()) return;
  Table table;
  try {
    table = table_.read(lines);
  } catch (const std::runtime_error& error) {
    const std::size_t half = lines.size() / 2;
    if (half == 0) return take(position, malformed(error.what()));
    read_rows(lines.first(half), position, take);
    return read_rows(lines.subspan(half), position + half, take);
  }
  if (table.rows() == 0) return take(position, Line::header);  // the line is a row of units
  for (std::size_t row = 0; row < lines.size(); ++row) take(position + row, accept(table, row));
}

void SampleReader::leave_out(double& value, const std::string& name, const char* instead) {
  if (!std::isfinite(value) || !is_missing(value)) return;
  remarks_.push_back(fmt::format("{} = {} is beyond {:g}, and {}", name, value, largest_measurement, instead));
  value = not_a_number;
}

/// For a missing input the last value is repeated, because the command is still in effect.
SampleReader::Line SampleReader::accept(const Table& table, std::size_t row) {
  const FilePlan& plan = table_.plan();
  remarks_.clear();
  next_.time_s = table_.time_s(table, row);
  next_.rest_s = table_.rest_s(table, row);
  if (!std::isfinite(next_.time_s))
    return malformed(fmt::format("{} is missing", data_.time.empty() ? "time" : data_.time.front()));
  for (const ColumnRef where : plan.where)
    if (const double value = table.numbers[where.column][row]; std::isnan(value) || value == 0.0) return Line::left_out;
  for (std::size_t i = 0; i < plan.state.size(); ++i) {
    double& value = next_.measurement(static_cast<Eigen::Index>(i));
    value = table.numbers[plan.state[i].column][row];
    leave_out(value, data_.state[i], "counts as missing");
  }
  for (std::size_t i = 0; i < plan.input.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    double& value = next_.input(at);
    value = table.numbers[plan.input[i].column][row];
    leave_out(value, data_.input[i], "the last known value is used");
    if (std::isfinite(value)) continue;
    if (!any_input_) return malformed(fmt::format("{} is missing, and it has no earlier value", data_.input[i]));
    value = sample_.input(at);
  }
  any_input_ = true;
  std::swap(sample_, next_);
  return Line::sample;
}

}  // namespace modebank::app
