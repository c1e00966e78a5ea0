#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "io/table/table_reader.hpp"

namespace modebank {

/// A column of texts, or of numbers that the caller owns.
struct MemoryColumn {
  ColumnInfo info;
  std::variant<std::span<const double>, std::span<const std::int64_t>, std::vector<std::string>> values;
};

/// A table in memory that a program passes instead of a file. Its hash covers the names and values of the columns that
/// are read. Messages refer to a value as name:row, with rows counted from 0.
class MemoryTable final : public TableReader {
 public:
  /// Throws std::invalid_argument if columns have different lengths.
  MemoryTable(std::string name, std::vector<MemoryColumn> columns);

  std::vector<TableInfo> tables() const override;
  InputFile describe(const std::vector<TableRequest>& requests) const override;
  std::vector<Table> read(const std::vector<TableRequest>& requests, InputFile* file) const override;

 private:
  const MemoryColumn& column(const std::string& name) const;
  Table read_one(const TableRequest& request) const;
  std::vector<std::string> texts(const std::string& name) const;
  std::vector<double> numbers(const std::string& name, bool may_miss) const;
  void stamps(const TimeRequest& request, Table& table) const;
  [[noreturn]] void fail(std::size_t row, const std::string& column, const std::string& what) const;

  std::string name_;
  std::vector<MemoryColumn> columns_;
  std::size_t rows_ = 0;
};

}  // namespace modebank
