#include "app/text/text_table.hpp"

#include <algorithm>
#include <boost/algorithm/string.hpp>

#include "app/text/terminal.hpp"

namespace modebank::app {
namespace {

std::string padded(const std::string& text, int width, TextTable::Align align) {
  const std::string space(static_cast<std::size_t>(std::max(0, width - columns_of(text))), ' ');
  return align == TextTable::Align::left ? text + space : space + text;
}

}  // namespace

void TextTable::add(std::vector<std::string> cells, std::string remark) {
  rows_.push_back({std::move(cells), std::move(remark)});
}

namespace {

/// Removes the front of the text, because long names differ at their ends.
std::string shortened(const std::string& text, int most) {
  if (columns_of(text) <= most) return text;
  std::string end = text;
  while (columns_of(end) > most - 2) {
    std::size_t next = 1;
    while (next < end.size() && (static_cast<unsigned char>(end[next]) & 0xC0U) == 0x80U)
      ++next;  // moves to the start of the next UTF-8 character
    end.erase(0, next);
  }
  return ".." + end;
}

}  // namespace

TextTable TextTable::within(int width) const {
  constexpr int least = 8;
  const int most = std::max(least, width / (static_cast<int>(keys_) + 1) - 1);
  TextTable result = *this;
  for (Column& column : result.columns_) column.title = shortened(column.title, most);
  for (Row& row : result.rows_)
    for (std::string& cell : row.cells) cell = shortened(cell, most);
  return result;
}

std::vector<int> TextTable::widths(bool limited) const {
  std::vector<int> widths;
  for (std::size_t j = 0; j < columns_.size(); ++j) {
    int width = std::max(limited ? 0 : columns_[j].width, columns_of(columns_[j].title));
    for (const Row& row : rows_)
      if (j < row.cells.size()) width = std::max(width, columns_of(row.cells[j]));
    widths.push_back(width);
  }
  return widths;
}

std::string TextTable::part(const std::vector<std::size_t>& shown, const std::vector<int>& widths) const {
  std::vector<std::string> titles;
  for (const Column& column : columns_) titles.push_back(column.title);
  std::vector<Row> lines{{titles, ""}};
  lines.insert(lines.end(), rows_.begin(), rows_.end());
  std::string text;
  for (const Row& row : lines) {
    std::string line;
    for (const std::size_t j : shown)
      if (j < row.cells.size()) line += (line.empty() ? "" : " ") + padded(row.cells[j], widths[j], columns_[j].align);
    text += boost::trim_right_copy(line + row.remark) + "\n";
  }
  return text;
}

std::string TextTable::text(int width) const { return width > 0 ? within(width).laid_out(width) : laid_out(width); }

std::string TextTable::laid_out(int width) const {
  const std::vector<int> wide = widths(width > 0);
  int remark = 0;
  for (const Row& row : rows_) remark = std::max(remark, columns_of(row.remark));
  std::vector<std::size_t> keys(std::min(keys_, columns_.size()));
  int key_width = -1;
  for (std::size_t j = 0; j < keys.size(); ++j) key_width += 1 + wide[keys[j] = j];
  std::string text;
  for (std::size_t j = keys.size(); j < columns_.size() || text.empty();) {
    std::vector<std::size_t> shown = keys;
    int used = key_width + remark;
    do {
      if (j == columns_.size()) break;
      used += 1 + wide[j];
      shown.push_back(j++);
    } while (width <= 0 || (j < columns_.size() && used + 1 + wide[j] <= width));
    text += part(shown, wide);
  }
  return text;
}

}  // namespace modebank::app
