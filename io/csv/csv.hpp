#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/table/table_reader.hpp"

namespace modebank {

/// Comma-separated values (RFC 4180, read by libcsv) and similar dialects (io/csv/csv_dialect.hpp). A header row names
/// the columns, in any order and with exact case.
/// - Fields may be quoted. In quotes, "" is a quote; separators and line breaks are text.
/// - Also accepted: UTF-16, a byte-order mark, CRLF, blanks around fields, a missing last line break, and empty lines
///   before the header or after the last row.
/// - Errors: malformed quotes, rows of another width than the header, and empty lines between rows.

/// Column names of the file. Reads only as far as needed. Throws ConfigurationError if the file cannot be read or has
/// no header, and DataError if the header's quotes are malformed.
std::vector<std::string> read_csv_header(const std::filesystem::path& path);

/// Reads the requested columns of `content`. `file`: name for error messages. Throws as TableReader::read does.
Table parse_csv(std::string_view file, std::string_view content, const TableRequest& request,
                const FormatOptions& options = {});

/// The columns of a text, or of its beginning. Throws as read_csv_header does.
TableInfo csv_columns(std::string_view file, std::string_view content, const FormatOptions& options);

/// A text file: one table without a name.
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
