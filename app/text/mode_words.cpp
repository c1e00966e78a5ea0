#include "app/text/mode_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cmath>

#include "app/text/judged_runs.hpp"
#include "app/text/number_text.hpp"
#include "app/text/terminal.hpp"
#include "ident/base/not_a_number.hpp"
#include "io/archive/bank/units.hpp"

namespace modebank::app {
namespace {

constexpr int longest_name = 16;  // largest width of a name in a table
constexpr double standard_errors_95 = 1.96;

/// Lower end of the 95 % interval of tau. It is used if the interval of the rate 1 / tau reaches zero, so that the mode
/// may never die out. Otherwise zero. The interval is that of the rate, because the data determine the rate.
double least_time_constant(const Decay& decay) {
  const double time = decay.time_constant_s, reach = standard_errors_95 * decay.time_constant_error_s;
  return time != 0.0 && std::abs(time) <= reach ? time * time / (time + reach) : 0.0;
}

}  // namespace

std::string shortened(const std::string& name) {
  return columns_of(name) <= longest_name ? name : first_columns(name, longest_name - 2) + "..";
}

std::vector<bool> unidentifiable_parameters(const Archive& archive, const LinearStructure& s) {
  std::vector<bool> unidentifiable(static_cast<std::size_t>(s.parameters()), false);
  if (!archive.windows || !archive.windows->model_parameters.empty() || !(archive.windows->structure == s))
    return unidentifiable;
  const Eigen::ArrayXd variance = archive.windows->global.covariance.diagonal().array();
  if (variance.size() != s.parameters() || variance.isNaN().all()) return unidentifiable;
  for (Index j = 0; j < variance.size(); ++j) unidentifiable[static_cast<std::size_t>(j)] = std::isnan(variance(j));
  return unidentifiable;
}

bool unidentifiable_decays(const Archive& archive, const LinearStructure& s) {
  const std::vector<bool> parameters = unidentifiable_parameters(archive, s);
  for (Index i = 0; i < s.states; ++i)
    for (Index j = 0; j < s.dimension(); ++j)
      if (parameters[static_cast<std::size_t>(i * s.regressors() + j)]) return true;
  return false;
}

std::vector<bool> unidentifiable_gains(const Archive& archive, const LinearStructure& s) {
  const std::vector<bool> parameters = unidentifiable_parameters(archive, s);
  std::vector<bool> unidentifiable(static_cast<std::size_t>(s.states * s.inputs), unidentifiable_decays(archive, s));
  for (Index i = 0; i < s.states; ++i)
    for (Index j = 0; j < s.acting_inputs(); ++j)
      if (parameters[static_cast<std::size_t>(i * s.regressors() + s.dimension() + j)])
        unidentifiable[static_cast<std::size_t>(i * s.inputs + j % s.inputs)] = true;
  return unidentifiable;
}

std::string decay_words(const Decay& decay, const char* plus_minus, const std::string& unit) {
  const double time = decay.time_constant_s, least = least_time_constant(decay);
  std::string text = std::isinf(time) ? "integrates"
                     : least > 0.0    ? fmt::format("over {:.2g} {}", least, unit)
                     : time < 0.0     ? "unstable, held by the loop"
                     : time == 0.0    ? "at once"
                                      : estimate_text(time, decay.time_constant_error_s, plus_minus) + " " + unit;
  if (decay.frequency_hz > 0.0) text += fmt::format(", period {:.3g} {}", 1.0 / decay.frequency_hz, unit);
  return text;
}

std::string per_sample_words(const std::vector<Decay>& decays) {
  std::vector<std::string> texts;
  for (const Decay& decay : decays) texts.push_back(fmt::format("{:.3f}", decay.per_sample));
  return boost::algorithm::join(texts, "; ");
}

namespace {

/// The stay is computed from the transition matrix. For state-dependent transition probabilities, it is computed from
/// the sequence of most probable modes.
UsedMode judged_mode(const Archive& archive, const DiagnosticsRow& row) {
  double samples = row.dwell_model > 0.0 && row.dwell > 0.0 ? row.dwell_model : row.dwell;
  Index longest = 0;
  for (std::size_t i = 0; archive.recording && i < archive.recording->runs.size(); ++i)
    longest = std::max(longest, archive.recording->runs[i].samples());
  const bool at_least = longest > 0 && row.dwell_model > 0.0 && samples > static_cast<double>(longest);
  if (at_least) samples = static_cast<double>(longest);
  return {row.mode, row.usage, samples > 0.0 ? samples * archive.bank->dt_s : not_a_number, at_least};
}

std::vector<UsedMode> unjudged_modes(const Bank& bank) {
  std::vector<UsedMode> modes;
  for (Index k = 0; k < bank.mode_count(); ++k) {
    const double leave = 1.0 - bank.transition.matrix()(k, k);
    modes.push_back(
        {k, bank.modes[static_cast<std::size_t>(k)].weight, leave > 0.0 ? bank.dt_s / leave : not_a_number, false});
  }
  return modes;
}

std::vector<UsedMode> by_use(std::vector<UsedMode> modes) {
  std::stable_sort(modes.begin(), modes.end(), [](const UsedMode& a, const UsedMode& b) { return a.use > b.use; });
  return modes;
}

}  // namespace

std::string stay_words(const UsedMode& mode, const std::string& unit) {
  return std::isnan(mode.stay_s) ? "-" : fmt::format("{}{:.3g} {}", mode.at_least ? "over " : "", mode.stay_s, unit);
}

std::vector<UsedMode> used_modes(const Bank& bank) { return by_use(unjudged_modes(bank)); }

std::vector<UsedMode> used_modes(const Archive& archive) {
  std::vector<UsedMode> modes = unjudged_modes(*archive.bank);
  const Role role = judged_role(archive);
  for (const DiagnosticsRow& row : archive.diagnostics)
    if (row.filter == "bank" && row.role == role && row.mode >= 0 && row.mode < archive.bank->mode_count())
      modes[static_cast<std::size_t>(row.mode)] = judged_mode(archive, row);
  return by_use(std::move(modes));
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
      gains.names.push_back(shortened(state.name) + " per " + shortened(input.name));
      units.push_back(unit_ratio(state.unit, input.unit));
    }
  const bool shared = std::adjacent_find(units.begin(), units.end(), std::not_equal_to<>()) == units.end();
  if (shared && !units.empty() && units.front() != "1") gains.unit = units.front();
  for (std::size_t i = 0; i < units.size() && !shared; ++i)
    if (!units[i].empty() && units[i] != "1") gains.names[i] += " [" + units[i] + "]";
  return gains;
}

}  // namespace modebank::app
