#include "app/text/confusion_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "app/text/judged_runs.hpp"
#include "app/text/mode_names.hpp"
#include "app/text/text_table.hpp"

namespace modebank::app {

namespace {

using Eigen::Index;

Index mode_count(const Archive& archive) {
  Index modes = 0;
  for (const ConfusionRow& row : archive.confusion) modes = std::max(modes, row.mode + 1);
  return modes;
}

}  // namespace

std::string confusion_text(const Archive& archive, int width) {
  if (archive.confusion.empty()) return "";
  std::vector<TextTable::Column> columns{{"label", 9, TextTable::Align::left}, {"samples", 8}};
  for (Index mode = 0; mode < mode_count(archive); ++mode) columns.push_back({mode_title(archive.mode_names, mode), 8});
  TextTable table(columns);
  for (std::size_t i = 0; i < archive.confusion.size();) {
    const std::string& label = archive.confusion[i].label;
    std::vector<std::string> cells{one_line(label), ""};
    Index samples = 0;
    for (; i < archive.confusion.size() && archive.confusion[i].label == label; ++i) {
      samples += archive.confusion[i].samples;
      cells.push_back(fmt::format("{:.1f} %", 100 * archive.confusion[i].share));
    }
    cells[1] = std::to_string(samples);
    table.add(cells);
  }
  return fmt::format("\nmost probable mode of each label's samples, {} runs\n{}", words_for(archive.confusion[0].role),
                     table.text(width));
}

}  // namespace modebank::app
