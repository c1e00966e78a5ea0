#include "app/text/mode_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cmath>

#include "app/text/mode_names.hpp"
#include "app/text/number_text.hpp"
#include "app/text/terminal.hpp"
#include "app/text/text_table.hpp"
#include "filter/step/motions.hpp"

namespace modebank::app {
namespace {

constexpr std::size_t most_members = 4;  // largest number of a motion's modes in one cell of a table

std::vector<std::string> gain_cells(const Eigen::MatrixXd& gain, const Eigen::MatrixXd& error,
                                    const std::vector<bool>& unidentifiable) {
  std::vector<std::string> cells;
  const Eigen::VectorXd gains = gain.transpose().reshaped(), errors = error.transpose().reshaped();
  for (Index i = 0; i < gains.size(); ++i)
    cells.push_back(unidentifiable[static_cast<std::size_t>(i)] ? not_identifiable
                    : std::isnan(gains(i))                      ? "never settles"
                                                                : estimate_text(gains(i), errors(i)));
  return cells;
}

bool some_have_several(const Bank& bank) { return motion_count(bank) < bank.mode_count(); }

/// Name of a motion in a table. If some motion has several modes: "ice (0, 5, 3)" or "modes 2, 7". Otherwise: "4 grip"
/// or "2".
std::string motion_cell(const Motion& motion, bool several) {
  const std::string name = shortened(motion.name);
  if (!several) return name.empty() ? motion.numbers() : fmt::format("{} {}", motion.numbers(), name);
  if (!name.empty()) return fmt::format("{} ({})", name, motion.numbers(most_members));
  return fmt::format("{} {}", motion.modes.size() == 1 ? "mode" : "modes", motion.numbers(most_members));
}

std::vector<std::string> motion_headings(const GainNames& gains, bool several) {
  std::vector<std::string> headings{several ? "motion (modes)" : "mode", "used", "stay", "time constant"};
  headings.insert(headings.end(), gains.names.begin(), gains.names.end());
  return headings;
}

std::vector<ModeTable::Row> motion_rows(const Archive& archive, const std::vector<Motion>& motions, bool several,
                                        const std::string& unit) {
  const std::vector<bool> unidentifiable = unidentifiable_gains(archive, archive.bank->structure);
  const bool no_decays = unidentifiable_decays(archive, archive.bank->structure);
  std::vector<ModeTable::Row> rows;
  for (const Motion& motion : motions) {
    const UsedMode stay{motion.modes.front(), motion.use, motion.stay_s, motion.at_least};
    ModeTable::Row row{motion.modes,
                       {motion_cell(motion, several), fmt::format("{:.1f} %", 100 * motion.use), stay_words(stay, unit),
                        no_decays ? not_identifiable : decay_words(motion.slowest, "+-", unit)}};
    const std::vector<std::string> gains = gain_cells(motion.gain, motion.gain_error, unidentifiable);
    row.cells.insert(row.cells.end(), gains.begin(), gains.end());
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string text_of(const std::vector<std::string>& headings, const std::vector<ModeTable::Row>& rows, bool left,
                    int width) {
  std::vector<TextTable::Column> columns;
  for (const std::string& heading : headings)
    columns.push_back({heading, 0, left && columns.empty() ? TextTable::Align::left : TextTable::Align::right});
  TextTable table(std::move(columns));
  for (const ModeTable::Row& row : rows) table.add(row.cells);
  return table.text(width);
}

GainNames gains_of(const Archive& archive) {
  const Recording none;
  const Recording& recording = archive.recording ? *archive.recording : none;
  return gain_names(*archive.bank, recording.states, recording.inputs);
}

int widest_line(const std::string& text) {
  int widest = 0;
  for (const std::string& line : lines_of(text)) widest = std::max(widest, columns_of(line));
  return widest;
}

/// A table of all modes with all of their decays.
std::string all_modes(const Archive& archive, const GainNames& gains, int width, const std::string& unit) {
  const std::vector<bool> unidentifiable = unidentifiable_gains(archive, archive.bank->structure);
  const bool no_decays = unidentifiable_decays(archive, archive.bank->structure);
  std::vector<std::string> headings{"mode", "used", "stay", "decay/sample", "time constant"};
  headings.insert(headings.end(), gains.names.begin(), gains.names.end());
  std::vector<ModeTable::Row> rows;
  for (const UsedMode& used : used_modes(archive)) {
    const ModeDynamics dynamics = mode_dynamics(*archive.bank, used.mode);
    std::vector<std::string> times;
    for (const Decay& decay : dynamics.decays) times.push_back(decay_words(decay, "+-", unit));
    ModeTable::Row row{{used.mode},
                       {shortened(mode_cell(archive.mode_names, used.mode)), fmt::format("{:.1f} %", 100 * used.use),
                        stay_words(used, unit), no_decays ? "-" : per_sample_words(dynamics.decays),
                        no_decays ? not_identifiable : boost::algorithm::join(times, "; ")}};
    const std::vector<std::string> cells = gain_cells(dynamics.gain, dynamics.gain_error, unidentifiable);
    row.cells.insert(row.cells.end(), cells.begin(), cells.end());
    rows.push_back(std::move(row));
  }
  return text_of(headings, rows, !archive.mode_names.empty(), width);
}

/// A table of the motions. Empty unless some motion has several modes.
std::string all_motions(const Archive& archive, const GainNames& gains, int width, const std::string& unit) {
  if (!some_have_several(*archive.bank)) return "";
  const std::vector<Motion> motions = motions_of(archive);
  std::string text = wrapped("\nmotions: modes with the same parameters, which differ in noise\n", width) +
                     text_of(motion_headings(gains, true), motion_rows(archive, motions, true, unit), true, width);
  for (const Motion& motion : motions)
    if (motion.modes.size() > most_members) text += wrapped(motion.title() + "\n", width);
  return text;
}

}  // namespace

ModeTable mode_table(const Archive& archive, Index rows, const std::string& unit) {
  std::vector<Motion> motions = motions_of(archive);
  const bool several = some_have_several(*archive.bank);
  const auto all = static_cast<Index>(motions.size());
  const Index told = told_of(motions);
  const bool fit = rows == 0 || (told == all ? all : told + 1) <= rows;
  const Index shown = fit ? told : std::clamp<Index>(rows - 1, 1, told);
  const GainNames gains = gains_of(archive);
  ModeTable table{motion_headings(gains, several), {}, all - shown, 0.0, gains.unit};
  for (Index i = shown; i < all; ++i) table.others_use += motions[static_cast<std::size_t>(i)].use;
  motions.resize(static_cast<std::size_t>(shown));
  table.rows = motion_rows(archive, motions, several, unit);
  return table;
}

ShortModes short_modes(const Archive& archive, Index rows, int width, const std::string& unit) {
  ModeTable table = mode_table(archive, rows, unit);
  const bool left = !archive.mode_names.empty() || some_have_several(*archive.bank);
  ShortModes result{text_of(table.headings, table.rows, left, 0), 0};
  const std::size_t without_gains = table.headings.size() - gains_of(archive).names.size();
  while (widest_line(result.text) > width && table.headings.size() > without_gains) {
    table.headings.pop_back();
    for (ModeTable::Row& row : table.rows) row.cells.pop_back();
    ++result.gains_left_out;
    result.text = text_of(table.headings, table.rows, left, 0);
  }
  if (table.others > 0)
    result.text += fmt::format("and {} other{}, used {:.1f} %\n", table.others, table.others == 1 ? "" : "s",
                               100 * table.others_use);
  return result;
}

std::string modes_in_words(const Archive& archive, int width, const std::string& unit) {
  if (!archive.bank) return "";
  const GainNames gains = gains_of(archive);
  return fmt::format("\nmodes in words{}\n", gains.unit.empty() ? "" : fmt::format("; gains in {}", gains.unit)) +
         all_modes(archive, gains, width, unit) + all_motions(archive, gains, width, unit);
}

}  // namespace modebank::app
