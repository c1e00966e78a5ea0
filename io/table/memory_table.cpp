#include "io/table/memory_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <stdexcept>

#include "ident/base/not_a_number.hpp"
#include "io/files/sha256.hpp"
#include "io/table/number.hpp"
#include "io/table/stamp_column.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

std::size_t rows_of(const MemoryColumn& column) {
  return std::visit([](const auto& values) { return values.size(); }, column.values);
}

std::string text_of(const MemoryColumn& column, std::size_t row) {
  return std::visit([&](const auto& values) { return fmt::format("{}", values[row]); }, column.values);
}

/// Adds the column's name and values to the hash. The length of each text precedes it, so different columns give
/// different bytes.
void add_to_hash(const MemoryColumn& column, Sha256& hash, std::uint64_t& bytes) {
  const auto add = [&](const void* data, std::size_t size) {
    hash.update(data, size);
    bytes += size;
  };
  const auto add_text = [&](const std::string& text) {
    const std::uint64_t size = text.size();
    add(&size, sizeof size);
    add(text.data(), text.size());
  };
  add_text(column.info.name);
  if (const auto* texts = std::get_if<std::vector<std::string>>(&column.values))
    for (const std::string& text : *texts) add_text(text);
  else if (const auto* reals = std::get_if<std::span<const double>>(&column.values))
    add(reals->data(), reals->size_bytes());
  else
    add(std::get<std::span<const std::int64_t>>(column.values).data(), 8 * rows_of(column));
}

}  // namespace

MemoryTable::MemoryTable(std::string name, std::vector<MemoryColumn> columns)
    : name_(std::move(name)), columns_(std::move(columns)) {
  rows_ = columns_.empty() ? 0 : rows_of(columns_.front());
  for (const MemoryColumn& column : columns_)
    if (rows_of(column) != rows_) throw std::invalid_argument(name_ + ": the columns differ in length");
}

std::vector<TableInfo> MemoryTable::tables() const {
  TableInfo table;
  for (const MemoryColumn& column : columns_) table.columns.push_back(column.info);
  table.rows = rows_;
  return {std::move(table)};
}

InputFile MemoryTable::describe(const std::vector<TableRequest>& requests) const {
  Sha256 hash;
  InputFile file{name_, 0, {}};
  for (const TableRequest& request : requests) {
    std::vector<std::string> wanted = request.numbers;
    wanted.insert(wanted.end(), request.texts.begin(), request.texts.end());
    for (const std::string& name : {request.time.column, request.time.second})
      if (!name.empty()) wanted.push_back(name);
    for (const std::string& name : wanted) add_to_hash(column(name), hash, file.bytes);
  }
  file.sha256 = hash.hex();
  return file;
}

std::vector<Table> MemoryTable::read(const std::vector<TableRequest>& requests, InputFile* file) const {
  std::vector<Table> tables;
  for (const TableRequest& request : requests) tables.push_back(read_one(request));
  if (file != nullptr) *file = describe(requests);
  return tables;
}

const MemoryColumn& MemoryTable::column(const std::string& name) const {
  return columns_[column_position(name_, column_names(tables().front()), name)];
}

void MemoryTable::fail(std::size_t row, const std::string& column, const std::string& what) const {
  throw DataError(fmt::format("{}:{}: column {}: {}", name_, row, column, what));
}

Table MemoryTable::read_one(const TableRequest& request) const {
  Table table;
  table.line.resize(rows_);
  std::iota(table.line.begin(), table.line.end(), std::uint64_t{0});
  for (std::size_t i = 0; i < request.numbers.size(); ++i)
    table.numbers.push_back(numbers(request.numbers[i], i < request.may_miss.size() && request.may_miss[i]));
  for (const std::string& name : request.texts) table.texts.push_back(texts(name));
  if (!request.time.column.empty()) stamps(request.time, table);
  return table;
}

std::vector<std::string> MemoryTable::texts(const std::string& name) const {
  const MemoryColumn& source = column(name);
  if (const auto* given = std::get_if<std::vector<std::string>>(&source.values)) return *given;
  std::vector<std::string> texts;
  if (const auto* whole = std::get_if<std::span<const std::int64_t>>(&source.values))
    for (const std::int64_t value : *whole) texts.push_back(std::to_string(value));
  if (const auto* reals = std::get_if<std::span<const double>>(&source.values))
    for (const double value : *reals) texts.push_back(std::isfinite(value) ? fmt::format("{}", value) : "");
  return texts;
}

std::vector<double> MemoryTable::numbers(const std::string& name, bool may_miss) const {
  const MemoryColumn& source = column(name);
  if (const auto* whole = std::get_if<std::span<const std::int64_t>>(&source.values))
    return {whole->begin(), whole->end()};
  std::vector<double> values(rows_);
  const auto* reals = std::get_if<std::span<const double>>(&source.values);
  for (std::size_t row = 0; row < rows_; ++row) {
    const ParsedNumber number = reals ? ParsedNumber{(*reals)[row], NumberStatus::ok}
                                      : parse_number(std::get<std::vector<std::string>>(source.values)[row]);
    if (number.status == NumberStatus::text || number.status == NumberStatus::out_of_range)
      fail(row, name, "no number");
    const bool known = number.status == NumberStatus::ok && std::isfinite(number.value);
    if (!known && !may_miss) fail(row, name, "missing value");
    values[row] = known ? number.value : not_a_number;
  }
  return values;
}

void MemoryTable::stamps(const TimeRequest& request, Table& table) const {
  const MemoryColumn& source = column(request.column);
  StampColumn stamps(request, source.info.unit);
  stamps.reserve(rows_);
  const std::vector<std::string> first = request.second.empty() ? std::vector<std::string>() : texts(request.column);
  const std::vector<std::string> second = request.second.empty() ? first : texts(request.second);
  for (std::size_t row = 0; row < rows_; ++row) {
    NumberStatus status = NumberStatus::missing;
    if (!request.second.empty())
      status = stamps.add(first[row], second[row]);
    else if (const auto* whole = std::get_if<std::span<const std::int64_t>>(&source.values))
      status = (*whole)[row] == missing_stamp ? status : stamps.add((*whole)[row]);  // numpy's NaT
    else
      std::visit([&](const auto& values) { status = stamps.add(values[row]); }, source.values);
    if (status == NumberStatus::missing && request.may_miss)
      stamps.add_missing();
    else if (status != NumberStatus::ok)
      fail(row, request.column, stamps.complaint(status, text_of(source, row)));
  }
  stamps.finish(name_, table);
}

}  // namespace modebank
