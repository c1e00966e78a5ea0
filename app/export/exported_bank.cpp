#include "app/export/exported_bank.hpp"

#include <fmt/format.h>

#include <cmath>

#include "app/text/calibration_text.hpp"
#include "app/text/judged_runs.hpp"
#include "app/text/mode_names.hpp"
#include "app/text/mode_words.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/model/parameter_labels.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/archive/bank/units.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

std::vector<Channel> with_units(const std::vector<std::string>& names, const Unit& units) {
  std::vector<Channel> channels;
  for (std::size_t i = 0; i < names.size(); ++i) channels.push_back({names[i], i < units.size() ? units[i] : ""});
  return channels;
}

/// Standard errors in the order of theta (`pack`). The companion rows only shift samples, so they have no errors.
ModeErrors errors_of(const Bank& bank, const Mode& mode) {
  const LinearStructure& s = bank.structure;
  const Eigen::Index n = s.dimension(), m = s.acting_inputs(), r = s.regressors();
  ModeErrors errors{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, m), Eigen::VectorXd::Zero(n)};
  const bool known = mode.standard_error.size() == s.parameters();
  const Eigen::VectorXd theta =
      known ? mode.standard_error : Eigen::VectorXd(Eigen::VectorXd::Constant(s.parameters(), not_a_number));
  for (Eigen::Index i = 0; i < s.states; ++i) {
    errors.A.row(i) = theta.segment(i * r, n).transpose();
    errors.B.row(i) = theta.segment(i * r + n, m).transpose();
    if (s.intercept) errors.c(i) = theta(i * r + r - 1);
    if (s.centre.empty()) continue;  // else c is the constant of theta minus [A B] times the centre
    Eigen::VectorXd slope(r);
    slope << -s.acting_centre(), 1.0;
    const Eigen::MatrixXd& all = mode.parameter_covariance;
    const double variance = all.rows() == s.parameters() ? slope.dot(all.block(i * r, i * r, r, r) * slope) : 0.0;
    errors.c(i) = variance > 0.0 ? std::sqrt(variance) : not_a_number;
  }
  return errors;
}

void add_verdict(const Archive& archive, ExportedBank& exported) {
  const Role role = judged_role(archive);
  const DiagnosticsRow* row = diagnosis(archive, exported.filter, role);
  if (archive.finding && exported.filter == "bank") exported.finding = archive.finding->text;
  if (!row) return;
  exported.verdict = row->verdict;
  exported.verdict_words = verdict_text(*row);
  exported.judged_on = words_for(role);
  exported.coverage_95 = row->coverage_95;
}

void add_channels(const Recording& recording, ExportedBank& exported) {
  const Units units(recording);
  const Bank& bank = exported.bank;
  exported.states = with_units(bank.state_names, units.states(bank.state_names));
  exported.inputs = with_units(bank.input_names, units.inputs(bank.input_names));
  exported.recorded_inputs = recording.inputs;
  exported.measurements = recording.states;
  exported.parameter_names = parameter_labels(bank.structure, bank.state_names, bank.input_names);
  exported.parameter_units = parameter_units(bank.structure, units.states(), units.inputs());
  // A bank from another archive may have more channels than this archive's runs.
  for (Index i = std::ssize(exported.measurements); i < bank.C.rows(); ++i)
    exported.measurements.push_back({fmt::format("y{}", i + 1), ""});
  exported.measurements.resize(static_cast<std::size_t>(bank.C.rows()));
  for (Index i = std::ssize(exported.recorded_inputs); i < bank.structure.inputs; ++i)
    exported.recorded_inputs.push_back({fmt::format("u{}", i + 1), ""});
  exported.recorded_inputs.resize(static_cast<std::size_t>(bank.structure.inputs));
}

void add_modes(const Archive& archive, ExportedBank& exported) {
  const Bank& bank = exported.bank;
  const bool learned = exported.filter == "bank";
  const std::vector<std::string> names = learned ? archive.mode_names : std::vector<std::string>();
  const std::vector<UsedMode> modes = learned ? used_modes(archive) : used_modes(bank);
  exported.motions = motions_of(bank, names, modes);
  exported.use.resize(learned ? modes.size() : 0);
  for (std::size_t j = 0; j < bank.modes.size(); ++j) {
    if (learned) exported.use[static_cast<std::size_t>(modes[j].mode)] = modes[j].use;
    const std::string name = name_of_mode(names, static_cast<Index>(j));
    exported.mode_names.push_back(name.empty() ? fmt::format("mode {}", j) : name);
    exported.errors.push_back(errors_of(bank, bank.modes[j]));
  }
}

}  // namespace

std::string ExportedBank::verdict_text() const {
  if (judged_on.empty()) return "not judged: no run was scored";
  return fmt::format("{}: {:.1f} % of the {} samples lie in the 95 % band", verdict_words, 100.0 * coverage_95,
                     judged_on);
}

ExportedBank exported_bank(const Archive& archive, const OpenArchive& file, const std::string& filter,
                           const FilterOptions& options, double input_lag_s) {
  const std::optional<Bank> bank = archive.bank_of(filter);
  if (!bank) throw DataError(fmt::format("{}: holds no {}", file.path().string(), filter));
  ExportedBank exported;
  exported.filter = filter;
  exported.archive = file.path().filename().string();
  exported.sha256 = file.digest();
  exported.provenance = archive.provenance;
  exported.options = options;
  exported.bank = *bank;
  exported.input_lag_s = input_lag_s;
  add_verdict(archive, exported);
  add_channels(archive.recording.value_or(Recording()), exported);
  exported.unidentifiable = unidentifiable_parameters(archive, bank->structure);
  add_modes(archive, exported);
  return exported;
}

}  // namespace modebank::app
