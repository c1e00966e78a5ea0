#include <fmt/format.h>

#include <algorithm>

#include "app/config/config_file.hpp"
#include "app/report/page/numbers.hpp"
#include "app/report/page/run_sections.hpp"
#include "app/report/page/unit_text.hpp"
#include "app/text/judged_runs.hpp"
#include "app/text/mode_names.hpp"
#include "app/text/mode_tables.hpp"
#include "app/text/mode_words.hpp"
#include "app/text/number_text.hpp"
#include "ident/model/parameter_labels.hpp"
#include "io/archive/bank/units.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;

/// All time constants in one cell, the slowest first. The table sorts by the slowest.
json decays_cell(const std::vector<Decay>& decays, const std::string& unit) {
  std::string text;
  for (const Decay& decay : decays) text += (text.empty() ? "" : "; ") + decay_words(decay, "±", unit);
  return number(decays.empty() ? 0.0 : decays.front().time_constant_s, text);
}

/// `open`: true for unidentifiable values. An empty list means that all values are identifiable.
json estimates(const Eigen::VectorXd& values, const Eigen::VectorXd& errors,
               const std::vector<bool>& unidentifiable = {}) {
  json cells = json::array();
  for (Index i = 0; i < values.size(); ++i) {
    const bool is_unidentifiable =
        static_cast<std::size_t>(i) < unidentifiable.size() && unidentifiable[static_cast<std::size_t>(i)];
    cells.push_back(is_unidentifiable ? number(NAN, not_identifiable)
                                      : estimate(values(i), i < errors.size() ? errors(i) : NAN));
  }
  return cells;
}

/// Adds the slowest mode of motion's decay per sample, and all time constants.
void add_decays(json& row, const std::vector<Decay>& decays, bool unidentifiable, const std::string& unit) {
  const double slowest = decays.empty() || unidentifiable ? NAN : decays.front().per_sample;
  row["per_sample"] = number(slowest, unidentifiable ? "-" : per_sample_words(decays));
  row["decays"] = unidentifiable ? number(NAN, not_identifiable) : decays_cell(decays, unit);
}

json mode_row(const Archive& archive, const Bank& bank, Index k, const std::string& unit) {
  const Mode& mode = bank.modes[static_cast<std::size_t>(k)];
  const ModeDynamics dynamics = mode_dynamics(bank, k);
  const Eigen::VectorXd gain = dynamics.gain.transpose().reshaped(), error = dynamics.gain_error.transpose().reshaped();
  const Index n_y = bank.C.rows();
  json row{
      {"mode", k},
      {"weight", number(mode.weight, fmt::format("{:.3f}", mode.weight))},
      {"parameters", estimates(bank.theta(k), mode.standard_error, unidentifiable_parameters(archive, bank.structure))},
      {"motion", estimates(mode.motion_theta, mode.motion_standard_error)},
      {"noise_sd", number_list(mode.Q.diagonal().head(std::min(n_y, mode.Q.rows())).cwiseSqrt())},
      {"gains", estimates(gain, error, unidentifiable_gains(archive, bank.structure))}};
  add_decays(row, dynamics.decays, unidentifiable_decays(archive, bank.structure), unit);
  return row;
}

void add_diagnosis(json& row, const DiagnosticsRow& diagnosis, double dt_s) {
  row["stay_seen"] = number(diagnosis.dwell * dt_s);
  row["usage"] = number(diagnosis.usage, fmt::format("{:.3f}", diagnosis.usage));
  row["samples"] = count(diagnosis.samples);
  row["stay_model"] = number(diagnosis.dwell_model * dt_s);
  row["too_far"] = percent(diagnosis.too_far);
  row["too_close"] = percent(diagnosis.too_close);
  row["verdict"] = name_of(diagnosis.verdict);
}

json column_names(const std::vector<std::string>& names, const Unit& units) {
  json columns = json::array();
  for (std::size_t i = 0; i < names.size(); ++i)
    columns.push_back(with_unit(names[i], i < units.size() && units[i] != "1" ? units[i] : ""));
  return columns;
}

std::vector<std::string> steady_gain_names(const Bank& bank, const Recording& recording) {
  std::vector<std::string> names;
  const std::vector<std::string> inputs = names_of(recording.inputs), states = names_of(recording.states);
  for (Index i = 0; i < bank.C.rows(); ++i)
    for (Index j = 0; j < bank.structure.inputs; ++j)
      names.push_back(
          fmt::format("{} per {}", states.at(static_cast<std::size_t>(i)), inputs.at(static_cast<std::size_t>(j))));
  return names;
}

std::vector<std::string> motion_names(const Bank& bank) {
  std::vector<std::string> names;
  for (const ModelParameter& parameter : bank.motion_parameters)
    names.push_back(parameter_words(parameter.name, parameter.unit));
  return names;
}

json transition_of(const Bank& bank) {
  json rows = json::array();
  const Eigen::MatrixXd& T = bank.transition.matrix();
  for (Index i = 0; i < T.rows(); ++i) {
    json row = json::array();
    for (Index j = 0; j < T.cols(); ++j)
      row.push_back(bank.transition_standard_error.size() > 0 ? estimate(T(i, j), bank.transition_standard_error(i, j))
                                                              : number(T(i, j)));
    rows.push_back(row);
  }
  return rows;
}

/// The weights of state-dependent transition probabilities; null for a constant T.
json switch_weights_of(const Bank& bank) {
  const TransitionLogit& logit = bank.transition_logit;
  if (logit.empty()) return nullptr;
  json rows = json::array();
  for (Index k = 0; k < bank.mode_count(); ++k) {
    json row = json::array();
    for (Index a = 0; a < logit.weights.cols(); ++a) row.push_back(number(logit.weights(k, a)));
    rows.push_back(row);
  }
  return {{"names", regressor_labels(bank.structure, bank.state_names, bank.input_names)}, {"rows", rows}};
}

std::string square_of(const std::string& unit) { return unit.empty() ? "" : fmt::format("({})²", unit); }

json screened_of(const Bank& bank) {
  json list = json::array();
  for (const ScreenedMode& mode : bank.screened)
    list.push_back({{"component", mode.component},
                    {"weight", number(mode.weight)},
                    {"radius", number(mode.spectral_radius)},
                    {"reason", mode.reason}});
  return list;
}

/// For each motion: title, modes, use, stay, time constant and gains.
json motions_json(const Archive& archive, const std::vector<Motion>& motions, const std::string& unit) {
  const LinearStructure& structure = archive.bank->structure;
  const std::vector<bool> unidentifiable = unidentifiable_gains(archive, structure);
  const bool no_decays = unidentifiable_decays(archive, structure);
  json list = json::array();
  for (const Motion& motion : motions) {
    const UsedMode stay{motion.modes.front(), motion.use, motion.stay_s, motion.at_least};
    list.push_back(
        {{"title", motion.title()},
         {"modes", motion.modes},
         {"use", number(motion.use, fmt::format("{:.1f} %", 100 * motion.use))},
         {"stay", number(motion.stay_s, stay_words(stay, unit))},
         {"decays", no_decays ? number(NAN, not_identifiable)
                              : number(motion.slowest.time_constant_s, decay_words(motion.slowest, "±", unit))},
         {"gains",
          estimates(motion.gain.transpose().reshaped(), motion.gain_error.transpose().reshaped(), unidentifiable)}});
  }
  return list;
}

/// For each label, the motions to which the bank assigns the samples with this label. Null without labels.
json label_section(const Archive& archive, const std::vector<Motion>& motions) {
  if (archive.confusion.empty()) return nullptr;
  const auto told = static_cast<std::size_t>(told_of(motions));
  struct Label {
    std::string name;
    Index samples = 0;
    std::vector<double> shares;  // one share per motion with its own row, then the share of all others
  };
  std::vector<Label> labels;
  for (const ConfusionRow& row : archive.confusion) {
    if (labels.empty() || labels.back().name != row.label)
      labels.push_back({row.label, 0, std::vector<double>(told + 1, 0.0)});
    labels.back().samples += row.samples;
    const auto place = std::find_if(motions.begin(), motions.end(), [&](const Motion& motion) {
      return motion.number == archive.bank->motion_of(row.mode);
    });
    labels.back().shares[std::min(static_cast<std::size_t>(place - motions.begin()), told)] += row.share;
  }
  json rows = json::array();
  for (const Label& label : labels) {
    rows.push_back({{"label", label.name}, {"samples", count(label.samples)}, {"shares", json::array()}});
    for (const double share : label.shares) rows.back()["shares"].push_back(percent(share));
  }
  return {{"role", name_of(archive.confusion.front().role)}, {"rows", rows}};
}

}  // namespace

nlohmann::json bank_section(const Archive& archive) {
  if (!archive.bank || !archive.recording) return nullptr;
  const Bank& bank = *archive.bank;
  const Recording& recording = *archive.recording;
  const Units units(recording);
  const std::string unit = time_unit(resolved_values(archive.config));
  const Role role = diagnosis(archive, "bank", Role::test) ? Role::test : Role::train;
  const std::vector<Motion> motions = motions_of(archive);
  const Index told = told_of(motions);
  std::vector<Index> order;
  std::size_t told_modes = 0;
  for (const Motion& motion : motions) {
    order.insert(order.end(), motion.modes.begin(), motion.modes.end());
    if (&motion - motions.data() < told) told_modes = order.size();
  }
  json modes = json::array();
  for (Index k = 0; k < bank.mode_count(); ++k) {
    modes.push_back(mode_row(archive, bank, k, unit));
    modes.back()["name"] = name_of_mode(archive.mode_names, k);
    if (const DiagnosticsRow* row = diagnosis(archive, "bank", role, k)) add_diagnosis(modes.back(), *row, bank.dt_s);
  }
  for (const UsedMode& mode : used_modes(archive)) {
    json& row = modes[static_cast<std::size_t>(mode.mode)];
    row["use"] = number(mode.use, fmt::format("{:.1f} %", 100 * mode.use));
    row["stay"] = number(mode.stay_s, stay_words(mode, unit));  // same words as on the first screen
  }
  return {{"modes", modes},
          {"baseline", archive.baseline ? mode_row(archive, *archive.baseline, 0, unit) : json()},
          {"role", name_of(role)},
          {"model", bank.model},
          {"dt_s", number(bank.dt_s)},
          {"parameter_names", column_names(parameter_labels(bank.structure, bank.state_names, bank.input_names),
                                           parameter_units(bank.structure, units.states(), units.inputs()))},
          {"motion_names", column_names(motion_names(bank), unit_of(bank.motion_parameters))},
          {"gain_names", column_names(steady_gain_names(bank, recording), ratios(units.states(), units.inputs()))},
          {"noise_name", with_unit("step noise sd", common_unit(recording.states))},
          {"noise_variance_name", with_unit("Measurement noise variance R", square_of(common_unit(recording.states)))},
          {"R", number_list(bank.R.diagonal())},
          {"motions", motions_json(archive, motions, unit)},
          {"told_motions", told},
          {"order", order},
          {"told", told_modes},
          {"transition", transition_of(bank)},
          {"switch_weights", switch_weights_of(bank)},
          {"confusion", label_section(archive, motions)},
          {"screened", screened_of(bank)},
          {"refined", archive.unrefined.has_value()}};
}

}  // namespace modebank::app::report
