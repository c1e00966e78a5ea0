#include "io/import/table_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>

#include "ident/base/nearest_name.hpp"
#include "io/files/read_file.hpp"
#include "io/files/sha256.hpp"
#include "io/import/csv.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

class CsvReader : public TableReader {
 public:
  explicit CsvReader(std::filesystem::path path) : path_(std::move(path)) {}

  std::vector<std::string> columns() const override { return read_csv_header(path_); }

  Table read(const TableRequest& request, InputFile& file) const override {
    const std::string content = read_file(path_);
    Table table;
    std::string sha256;
    tbb::parallel_invoke([&] { sha256 = sha256_hex(content); },
                         [&] { table = parse_csv(path_.string(), content, request); });
    file = {path_.string(), content.size(), std::move(sha256)};
    return table;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace

std::unique_ptr<TableReader> open_table(const std::filesystem::path& path) { return std::make_unique<CsvReader>(path); }

std::size_t column_position(std::string_view file, const std::vector<std::string>& columns, const std::string& column) {
  const auto found = std::find(columns.begin(), columns.end(), column);
  if (found == columns.end())
    throw ConfigurationError(fmt::format("{} has no column \"{}\"{}; columns: {}", file, column,
                                         did_you_mean(column, columns), fmt::join(columns, ", ")));
  if (std::find(found + 1, columns.end(), column) != columns.end())
    throw ConfigurationError(fmt::format("{} has column \"{}\" twice", file, column));
  return static_cast<std::size_t>(found - columns.begin());
}

}  // namespace modebank
