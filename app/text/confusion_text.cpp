#include "app/text/confusion_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "app/chain/judged_runs.hpp"
#include "app/text/text_table.hpp"

namespace modebank::app {

namespace {

using Eigen::Index;

constexpr double enough = 0.6;  // of a mode's samples for a label to be its name

Index samples_of(const Archive& archive, Index mode) {
  Index samples = 0;
  for (const ConfusionRow& row : archive.confusion) samples += row.mode == mode ? row.samples : 0;
  return samples;
}

Index mode_count(const Archive& archive) {
  Index modes = 0;
  for (const ConfusionRow& row : archive.confusion) modes = std::max(modes, row.mode + 1);
  return modes;
}

}  // namespace

std::string label_of_mode(const Archive& archive, Index mode) {
  const auto all = static_cast<double>(samples_of(archive, mode));
  for (const ConfusionRow& row : archive.confusion)
    if (row.mode == mode && row.samples > 0 && static_cast<double>(row.samples) >= enough * all) return row.label;
  return {};
}

std::string confusion_text(const Archive& archive, int width) {
  if (archive.confusion.empty()) return "";
  std::vector<TextTable::Column> columns{{"label", 9, TextTable::Align::left}, {"samples", 8}};
  for (Index mode = 0; mode < mode_count(archive); ++mode) columns.push_back({fmt::format("mode {}", mode), 8});
  TextTable table(columns);
  for (std::size_t i = 0; i < archive.confusion.size();) {
    const std::string& label = archive.confusion[i].label;
    std::vector<std::string> cells{label, ""};
    Index samples = 0;
    for (; i < archive.confusion.size() && archive.confusion[i].label == label; ++i) {
      samples += archive.confusion[i].samples;
      cells.push_back(fmt::format("{:.1f} %", 100 * archive.confusion[i].share));
    }
    cells[1] = std::to_string(samples);
    table.add(cells);
  }
  std::string names;
  for (Index mode = 0; mode < mode_count(archive); ++mode)
    if (const std::string label = label_of_mode(archive, mode); !label.empty())
      names += fmt::format("{}mode {} is {}", names.empty() ? "" : ", ", mode, label);
  return fmt::format("\nmost probable mode of each label's samples, {} runs{}\n{}",
                     words_for(archive.confusion[0].role), names.empty() ? "" : ": " + names, table.text(width));
}

}  // namespace modebank::app
