#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// A table of text that fits a terminal: columns that are too many continue below, with the key columns repeated.
class TextTable {
 public:
  enum class Align { left, right };
  struct Column {
    std::string title;
    int width;  ///< smallest width without a limit; wider cells widen it
    Align align = Align::right;
  };

  /// Every part repeats the first `keys` columns.
  TextTable(std::vector<Column> columns, std::size_t keys = 1) : columns_(std::move(columns)), keys_(keys) {}

  /// One cell per column, or fewer for a row that ends early. `remark` follows the row.
  void add(std::vector<std::string> cells, std::string remark = {});

  /// width 0: no limit. Otherwise a cell that is too wide is shortened to its end.
  std::string text(int width) const;

 private:
  struct Row {
    std::vector<std::string> cells;
    std::string remark;
  };
  TextTable within(int width) const;
  std::string laid_out(int width) const;
  std::vector<int> widths(bool limited) const;
  std::string part(const std::vector<std::size_t>& shown, const std::vector<int>& widths) const;

  std::vector<Column> columns_;
  std::size_t keys_;
  std::vector<Row> rows_;
};

}  // namespace modebank::app
