#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/table/table_reader.hpp"

namespace modebank {

/// Comma-separated values (RFC 4180, read by libcsv) and similar dialects (io/csv/csv_dialect.hpp). A header row names
/// the columns. Their order is free; upper and lower case matter.
/// - Fields may be in quotes. Within quotes, "" means one quote; separators and line breaks are text.
/// - Also accepted: UTF-16, a byte-order mark, CRLF, blanks around fields, a missing last line break, and empty lines
/// before the header or after the last row.
/// - Errors: malformed quotes, rows whose width differs from the header's, and empty lines between rows.

/// Reads the requested columns of `content`. `file`: name for error messages. Throws the same exceptions as
/// TableReader::read.
Table parse_csv(std::string_view file, std::string_view content, const TableRequest& request,
                const FormatOptions& options = {});

/// Column names of a text, or of the beginning of a text. Throws the same exceptions as read_csv_head.
TableInfo csv_columns(std::string_view file, std::string_view content, const FormatOptions& options);

/// A text file as one table without a name.
class CsvReader : public TableReader {
 public:
  CsvReader(std::filesystem::path path, const FormatOptions& options) : path_(std::move(path)), options_(options) {}
  std::vector<TableInfo> tables() const override;
  InputFile describe(const std::vector<TableRequest>& requests) const override;
  std::vector<Table> read(const std::vector<TableRequest>& requests, InputFile* file) const override;

 private:
  std::filesystem::path path_;
  FormatOptions options_;
};

}  // namespace modebank
