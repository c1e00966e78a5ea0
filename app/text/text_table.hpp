#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// A table of text that fits a terminal. Columns that do not fit continue below, together with the key columns.
class TextTable {
 public:
  enum class Align { left, right };
  struct Column {
    std::string title;
    int width;  ///< smallest width; the column is wider if a cell is wider
    Align align = Align::right;
  };

  /// `keys`: number of columns at the start that every part repeats.
  TextTable(std::vector<Column> columns, std::size_t keys = 1) : columns_(std::move(columns)), keys_(keys) {}

  /// Adds a row with one cell per column, or fewer if the row ends early. `remark` follows the row.
  void add(std::vector<std::string> cells, std::string remark = {});

  /// `width`: 0 means no limit. Otherwise only the end of a cell that is too wide is shown.
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
