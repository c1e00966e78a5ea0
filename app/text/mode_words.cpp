#include "app/text/mode_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cmath>

#include "app/chain/judged_runs.hpp"
#include "app/chain/mode_names.hpp"
#include "app/text/number_text.hpp"
#include "app/text/terminal.hpp"
#include "app/text/text_table.hpp"
#include "ident/base/not_a_number.hpp"
#include "io/archive/bank/units.hpp"

namespace modebank::app {
namespace {

constexpr Index most_modes = 8;
constexpr double least_use = 0.01;  // modes used less are "others" in a short table
constexpr int longest_name = 16;    // columns of a channel's name in a heading

std::string seconds(double value) { return std::isnan(value) ? "-" : fmt::format("{:.3g} s", value); }

/// A channel's name, its middle left out where it is long.
std::string heading(const std::string& name) {
  const int columns = columns_of(name);
  if (columns <= longest_name) return name;
  return first_columns(name, longest_name - 2) + "..";
}

/// Per gain (states x inputs, a state's in a row) whether the training runs leave it open: some effect of the input on
/// the state has no standard error in the global model.
std::vector<bool> open_gains(const Archive& archive) {
  const LinearStructure& s = archive.bank->structure;
  std::vector<bool> open(static_cast<std::size_t>(s.states * s.inputs), false);
  if (!archive.windows || !archive.windows->model_parameters.empty() || !(archive.windows->structure == s)) return open;
  const Eigen::VectorXd variance = archive.windows->global.covariance.diagonal();
  if (variance.size() != s.parameters()) return open;
  for (Index i = 0; i < s.states; ++i)
    for (Index j = 0; j < s.acting_inputs(); ++j)
      if (std::isnan(variance(i * s.regressors() + s.dimension() + j)))
        open[static_cast<std::size_t>(i * s.inputs + j % s.inputs)] = true;
  return open;
}

/// What a table of modes holds beside the gains.
struct Cells {
  bool all_decays;
  std::size_t gains;
  std::vector<bool> open;
  const std::vector<std::string>& names;  // of modes
};

std::vector<std::string> cells_of(const UsedMode& used, const ModeDynamics& dynamics, const Cells& wanted) {
  std::vector<Decay> decays = dynamics.decays;
  if (!wanted.all_decays && decays.size() > 1) decays.resize(1);
  std::vector<std::string> times;
  for (const Decay& decay : decays) times.push_back(decay_words(decay));
  std::vector<std::string> cells{heading(mode_cell(wanted.names, used.mode)), fmt::format("{:.1f} %", 100 * used.use),
                                 seconds(used.stay_s), per_sample_words(decays), boost::algorithm::join(times, "; ")};
  const Eigen::VectorXd gains = dynamics.gain.transpose().reshaped(),
                        errors = dynamics.gain_error.transpose().reshaped();
  for (std::size_t i = 0; i < wanted.gains; ++i)
    cells.push_back(i < wanted.open.size() && wanted.open[i]
                        ? "not identifiable"
                        : estimate_text(gains(static_cast<Index>(i)), errors(static_cast<Index>(i))));
  return cells;
}

std::string table_text(const Archive& archive, const std::vector<UsedMode>& modes, const GainNames& gains,
                       const Cells& wanted, int width) {
  const auto align = wanted.names.empty() ? TextTable::Align::right : TextTable::Align::left;
  std::vector<TextTable::Column> columns{
      {"mode", 0, align}, {"used", 0}, {"stay", 0}, {"decay/sample", 0}, {"time constant", 0}};
  for (std::size_t i = 0; i < wanted.gains; ++i) columns.push_back({gains.names[i], 0});
  TextTable table(std::move(columns));
  for (const UsedMode& mode : modes) table.add(cells_of(mode, mode_dynamics(*archive.bank, mode.mode), wanted));
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

}  // namespace

std::string decay_words(const Decay& decay, const char* plus_minus) {
  const double time = decay.time_constant_s;
  std::string text = std::isinf(time) ? "integrates"
                     : time < 0.0     ? fmt::format("unstable: grows e-fold in {:.3g} s", -time)
                     : time == 0.0    ? "at once"
                                      : estimate_text(time, decay.time_constant_error_s, plus_minus) + " s";
  if (decay.frequency_hz > 0.0) text += fmt::format(", period {:.3g} s", 1.0 / decay.frequency_hz);
  return text;
}

std::string per_sample_words(const std::vector<Decay>& decays) {
  std::vector<std::string> texts;
  for (const Decay& decay : decays) texts.push_back(fmt::format("{:.3f}", decay.per_sample));
  return boost::algorithm::join(texts, "; ");
}

std::vector<UsedMode> used_modes(const Archive& archive) {
  const Bank& bank = *archive.bank;
  std::vector<UsedMode> modes;
  for (Index k = 0; k < bank.mode_count(); ++k) {
    const double leave = 1.0 - bank.transition.matrix()(k, k);
    modes.push_back({k, bank.modes[static_cast<std::size_t>(k)].weight,
                     bank.mode_count() > 1 && leave > 0.0 ? bank.dt_s / leave : not_a_number});
  }
  const Role role = judged_role(archive);
  for (const DiagnosticsRow& row : archive.diagnostics)
    if (row.filter == "bank" && row.role == role && row.mode >= 0 && row.mode < bank.mode_count())
      modes[static_cast<std::size_t>(row.mode)] = {row.mode, row.usage,
                                                   row.dwell > 0.0 ? row.dwell * bank.dt_s : not_a_number};
  std::stable_sort(modes.begin(), modes.end(), [](const UsedMode& a, const UsedMode& b) { return a.use > b.use; });
  return modes;
}

GainNames gain_names(const Bank& bank, const std::vector<Channel>& states, const std::vector<Channel>& inputs) {
  GainNames gains;
  std::vector<std::string> units;
  const auto channel = [](const std::vector<Channel>& channels, Index i, char otherwise) {
    const auto at = static_cast<std::size_t>(i);
    return at < channels.size() ? channels[at] : Channel{otherwise + std::to_string(i + 1), ""};
  };
  for (Index i = 0; i < bank.C.rows(); ++i)
    for (Index j = 0; j < bank.structure.inputs; ++j) {
      const Channel state = channel(states, i, 'x'), input = channel(inputs, j, 'u');
      gains.names.push_back(heading(state.name) + " per " + heading(input.name));
      units.push_back(unit_ratio(state.unit, input.unit));
    }
  const bool shared = std::adjacent_find(units.begin(), units.end(), std::not_equal_to<>()) == units.end();
  if (shared && !units.empty() && units.front() != "1") gains.unit = units.front();
  for (std::size_t i = 0; i < units.size() && !shared; ++i)
    if (!units[i].empty() && units[i] != "1") gains.names[i] += " [" + units[i] + "]";
  return gains;
}

ShortModes short_modes(const Archive& archive, Index rows, int width) {
  std::vector<UsedMode> modes = used_modes(archive);
  const auto all = static_cast<Index>(modes.size());
  const Index worth =
      std::count_if(modes.begin(), modes.end(), [](const UsedMode& mode) { return mode.use >= least_use; });
  const Index told = std::min(most_modes, std::max<Index>(1, worth));
  const Index shown = told == all && all <= rows ? all : std::clamp<Index>(rows - 1, 1, told);
  double others = 0.0;
  for (Index i = shown; i < all; ++i) others += modes[static_cast<std::size_t>(i)].use;
  modes.resize(static_cast<std::size_t>(shown));
  const GainNames gains = gains_of(archive);
  Cells cells{false, gains.names.size(), open_gains(archive), archive.mode_names};
  ShortModes result{table_text(archive, modes, gains, cells, 0)};
  for (; widest_line(result.text) > width && cells.gains > 0; ++result.gains_left_out) {
    --cells.gains;
    result.text = table_text(archive, modes, gains, cells, 0);
  }
  if (shown < all)
    result.text +=
        fmt::format("and {} other{}, used {:.1f} %\n", all - shown, all - shown == 1 ? "" : "s", 100 * others);
  return result;
}

std::string modes_in_words(const Archive& archive, int width) {
  if (!archive.bank) return "";
  const GainNames gains = gains_of(archive);
  return fmt::format("\nmodes in words{}\n",
                     gains.unit.empty() ? "" : fmt::format("; steady gains in {}", gains.unit)) +
         table_text(archive, used_modes(archive), gains,
                    {true, gains.names.size(), open_gains(archive), archive.mode_names}, width);
}

}  // namespace modebank::app
