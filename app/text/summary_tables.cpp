#include "app/text/summary_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "app/text/judged_runs.hpp"
#include "app/text/mode_names.hpp"
#include "app/text/mode_words.hpp"
#include "app/text/number_text.hpp"
#include "app/text/terminal.hpp"
#include "app/text/text_table.hpp"
#include "ident/model/equations.hpp"
#include "ident/model/parameter_labels.hpp"
#include "ident/model/terms.hpp"
#include "ident/model/transitions.hpp"

namespace modebank::app {
namespace {

std::string unit_suffix(const Archive& archive) {
  if (!archive.recording || archive.recording->states.size() != 1) return "";
  const std::string& unit = archive.recording->states.front().unit;
  return unit.empty() ? "" : " [" + unit + "]";
}

/// Alignment of a column of modes: right for numbers alone, left for numbers with names.
TextTable::Align align_of(const std::vector<std::string>& mode_names) {
  return mode_names.empty() ? TextTable::Align::right : TextTable::Align::left;
}

std::string share(double value) { return fmt::format("{:.2f} %", 100 * value); }

std::string tails(double above, double below) { return fmt::format("{:.2f} % {:>5.2f} %", 100 * above, 100 * below); }

std::string estimate(double value, double standard_error) {
  // Outside this range, four decimals are unsuitable: a smaller error would print as zero, and a larger value is too
  // long.
  constexpr double smallest = 5e-5, largest = 1e5;
  if (std::abs(value) >= largest || standard_error >= largest || standard_error < smallest)
    return fmt::format("{:.6g} +- {:.2g}", value, standard_error);
  return fmt::format("{:.4f} +- {:.4f}", value, standard_error);
}

}  // namespace

std::string scores_text(const Archive& archive, int width) {
  using Align = TextTable::Align;
  TextTable table({{"filter", 11, Align::left},
                   {"role", 5, Align::left},
                   {"samples", 8},
                   {"log score", 10},
                   {"rmse" + unit_suffix(archive), 14},
                   {"in 95 % band", 12},
                   {"too far", 9},
                   {"too close", 9},
                   {"NIS above/below", 18},
                   {"mean NIS", 8},
                   {"white p", 8}},
                  2);
  for (const SummaryRow& row : archive.summary)
    if (row.run == "*")
      table.add({row.filter, std::string(name_of(row.role)), std::to_string(row.samples),
                 fixed_or_short(row.log_score, 4), size_list(row.rmse, 5), share(row.coverage_95), share(row.too_far),
                 share(row.too_close), tails(row.nis_above, row.nis_below), fixed_or_short(row.nis_mean, 3),
                 fmt::format("{:.2g}", row.whiteness_p)});
  return table.text(width) +
         "A correct filter has 95 % of samples in its 95 % band, 2.5 % too far from its prediction and 2.5 % too "
         "close\n"
         "(z^2 beyond the outer quantiles of chi-square); log score in nats per sample, higher is better.\n";
}

std::string candidates_text(const MixtureResult& mixture, int width) {
  TextTable table({{"K", 4},
                   {"shape", 8, TextTable::Align::left},
                   {"log likelihood", 14},
                   {"q", 6},
                   {"N_eff", 8},
                   {"BIC", 12},
                   {"AIC", 12},
                   {"naive BIC", 12},
                   {"iter", 6},
                   {"converged", 9},
                   {"agreeing", 8}},
                  2);
  for (const Candidate& c : mixture.candidates) {
    const std::string count = std::to_string(c.components), shape(name_of(c.covariance));
    if (c.status != CandidateStatus::fitted) {
      table.add({count, shape}, fmt::format(" {}{}{}", name_of(c.status), c.failed.empty() ? "" : ": ", c.failed));
      continue;
    }
    table.add({count, shape, fmt::format("{:.3f}", c.log_likelihood), std::to_string(c.parameters),
               fmt::format("{:.1f}", c.effective_samples), fmt::format("{:.3f}", c.bic), fmt::format("{:.3f}", c.aic),
               fmt::format("{:.3f}", c.bic_naive), std::to_string(c.iterations), c.converged ? "yes" : "no",
               fmt::format("{}/{}", c.agreeing_restarts, c.restarts)},
              fmt::format("{}{}", c.selected ? "  <- selected" : "", c.floor_active ? "  is at the floor" : ""));
  }
  return table.text(width);
}

std::string mode_diagnostics_text(const Archive& archive, int width) {
  const Role role = judged_role(archive);
  TextTable table({{"mode", 4, align_of(archive.mode_names)},
                   {"usage", 7},
                   {"expected", 8},
                   {"dwell", 8},
                   {"by T", 8},
                   {"in 95 % band", 12},
                   {"too far/close", 18},
                   {"mean NIS", 8},
                   {"NEES", 8},
                   {"white p", 8},
                   {"verdict", 7, TextTable::Align::left}});
  bool empty = true;
  for (const DiagnosticsRow& row : archive.diagnostics) {
    if (row.filter != "bank" || row.role != role || row.mode < 0) continue;
    empty = false;
    table.add({mode_cell(archive.mode_names, row.mode), fmt::format("{:.3f}", row.usage), std::to_string(row.samples),
               fixed_or_short(row.dwell, 1), fixed_or_short(row.dwell_model, 1), share(row.coverage_95),
               tails(row.too_far, row.too_close), fixed_or_short(row.nis_mean, 3), fixed_or_short(row.nees_mean, 3),
               fmt::format("{:.2g}", row.whiteness_p), std::string(name_of(row.verdict))});
  }
  return empty ? "" : fmt::format("\nmodes on {} runs\n{}", words_for(role), table.text(width));
}

namespace {

/// A table of the modes in the parameters of a motion model. Empty for linear models, because their table already has
/// all parameters.
std::string motion_parameters_text(const Bank& bank, const std::vector<std::string>& names, int width) {
  if (bank.motion_parameters.empty()) return "";
  std::vector<TextTable::Column> columns{{"mode", 4, align_of(names)}};
  for (const ModelParameter& parameter : bank.motion_parameters) columns.push_back({parameter.name, 20});
  TextTable table(std::move(columns));
  for (Index k = 0; k < bank.mode_count(); ++k) {
    const Mode& mode = bank.modes[static_cast<std::size_t>(k)];
    std::vector<std::string> cells{mode_cell(names, k)};
    for (Index i = 0; i < mode.motion_theta.size(); ++i)
      cells.push_back(estimate(mode.motion_theta(i), mode.motion_standard_error(i)));
    table.add(std::move(cells));
  }
  return "\nmodes as " + bank.model + "\n" + table.text(width);
}

}  // namespace

/// A table of the weights of state-dependent transition probabilities.
std::string switches_text(const Bank& bank, const std::vector<std::string>& names, int width) {
  const TransitionLogit& logit = bank.transition_logit;
  if (logit.empty()) return "";
  std::vector<TextTable::Column> columns{{"mode", 4, align_of(names)}};
  for (const std::string& label : regressor_labels(bank.structure, bank.state_names, bank.input_names))
    columns.push_back({label, 20});
  TextTable table(std::move(columns));
  for (Index k = 0; k < bank.mode_count(); ++k) {
    std::vector<std::string> cells{mode_cell(names, k)};
    for (Index a = 0; a < logit.weights.cols(); ++a) cells.push_back(fmt::format("{:.4f}", logit.weights(k, a)));
    table.add(std::move(cells));
  }
  return "\nswitches to each mode: log odds per unit of state and input\n" + table.text(width);
}

std::string equations_text(const Archive& archive, int width) {
  const Bank& bank = *archive.nonlinear;
  const Mode& mode = bank.modes.front();
  std::string text;
  for (const std::string& line :
       equations(bank.structure, mode.model, bank.terms, mode.bend, bank.state_names, bank.input_names))
    text += wrapped(line + "\n", width);
  const Role role = judged_role(archive);
  double outside = 0.0, transitions = 0.0;
  for (const Trajectory& run : archive.recording ? archive.recording->runs : std::vector<Trajectory>()) {
    if (run.role != role || run.samples() < 2) continue;
    const auto count = static_cast<double>(run.transitions());
    outside +=
        count * share_outside(bank.terms, stack_transitions(run, 0, run.transitions(), bank.structure).regressors);
    transitions += count;
  }
  if (transitions > 0.0)
    text += fmt::format(
        "{:.1f} % of the {} samples lie outside these ranges; there each term is held at its value at the edge\n",
        100.0 * outside / transitions, words_for(role));
  return text;
}

std::string modes_text(const Archive& archive, bool full_form, int width) {
  const Bank& bank = *archive.bank;
  const std::vector<std::string>& names = archive.mode_names;
  std::vector<TextTable::Column> columns{{"mode", 4, align_of(names)}, {"weight", 7}};
  const std::vector<std::string> labels = parameter_labels(bank.structure, bank.state_names, bank.input_names),
                                 parameters = bank.structure.parameter_names();
  for (std::size_t i = 0; i < labels.size(); ++i)
    columns.push_back({labels[i] + (full_form && parameters[i][0] == 'A' ? " (full)" : ""), 20});
  columns.push_back({"sqrt diag Q", 12});
  const std::vector<bool> unidentifiable = unidentifiable_parameters(archive, bank.structure);
  TextTable table(std::move(columns));
  for (Index k = 0; k < bank.mode_count(); ++k) {
    const Mode& mode = bank.modes[static_cast<std::size_t>(k)];
    Eigen::VectorXd theta = bank.theta(k);
    for (Index i = 0; full_form && i < bank.structure.states; ++i) theta(i * bank.structure.regressors() + i) += 1.0;
    std::vector<std::string> cells{mode_cell(names, k), fmt::format("{:.3f}", mode.weight)};
    for (Index i = 0; i < theta.size(); ++i)
      cells.push_back(unidentifiable[static_cast<std::size_t>(i)]
                          ? not_identifiable
                          : estimate(theta(i), mode.standard_error.size() > 0 ? mode.standard_error(i) : NAN));
    cells.push_back(fmt::format("{:.4g}", fmt::join(mode.Q.diagonal().cwiseSqrt().eval(), " ")));
    table.add(std::move(cells));
  }
  return table.text(width) + motion_parameters_text(bank, names, width) + switches_text(bank, names, width);
}

}  // namespace modebank::app
