#include "app/text/summary_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "app/text/confusion_text.hpp"
#include "app/text/judged_runs.hpp"
#include "app/text/lag_text.hpp"
#include "app/text/motions.hpp"
#include "app/text/response_text.hpp"
#include "app/text/structure_text.hpp"
#include "app/text/summary_tables.hpp"
#include "app/text/terminal.hpp"
#include "app/text/window_text.hpp"
#include "mixture/criteria.hpp"

namespace modebank::app {
namespace {

/// Number of windows with memberships. These windows were clustered or assigned, including windows with label -1
/// (noise).
Index member_windows(const MixtureResult& result) {
  if (!result.mixture.noise.present()) return (result.labels.array() >= 0).count();
  constexpr Index at_once = 16384;
  Index count = 0;
  for (Index first = 0; first < result.responsibilities.windows(); first += at_once) {
    const Index windows = std::min(at_once, result.responsibilities.windows() - first);
    count += (!result.responsibilities.block(first, windows).row(0).array().isNaN()).count();
  }
  return count;
}

std::string mixture_text(const Archive& archive) {
  const MixtureResult& result = *archive.mixture;
  const auto& candidates = result.candidates;
  const auto chosen = std::find_if(candidates.begin(), candidates.end(), [](const Candidate& c) { return c.selected; });
  std::string text =
      fmt::format("mixture   {} components over {}{}", result.mixture.components(),
                  fmt::join(feature_labels(archive, result.feature_names), ", "), features_origin(archive));
  if (chosen == candidates.end()) return text + "\n";
  const Index members = member_windows(result), clustered = result.clustered > 0 ? result.clustered : members;
  text +=
      fmt::format("; BIC {:.1f} with N_eff {:.0f} of {} windows", chosen->bic, chosen->effective_samples, clustered);
  if (clustered < members) text += fmt::format("; {} others, not of full rank, assigned to them", members - clustered);
  if (result.mixture.noise.present())
    text += fmt::format("; noise component {:.1f} %, label -1 for {} windows", 100 * result.mixture.noise.weight,
                        members - (result.labels.array() >= 0).count());
  if (candidates.size() > 1)
    text += fmt::format("; chosen from {}..{}", candidates.front().components, candidates.back().components);
  if (result.compared > 0) text += fmt::format(" on {} windows", of_all(result.compared, clustered));
  text += fmt::format("; {} of {} restarts agree\n", chosen->agreeing_restarts, chosen->restarts);
  for (const std::string& warning : selection_warnings(candidates)) text += "          warning: " + warning + "\n";
  return text;
}

std::string bank_text(const Bank& bank) {
  std::string text = "bank      " + motion_words(bank);
  for (const ScreenedMode& mode : bank.screened)
    text += fmt::format("; component {} screened: {}", mode.component, mode.reason);
  text += fmt::format("; R = {:.4g}", fmt::join(bank.R.diagonal(), " "));
  if (bank.is_quantised())
    text += fmt::format("; readings in steps of {:.4g}, log scores log(mass / step)", fmt::join(bank.quantum, " "));
  return text + "\n";
}

/// Whether the filter has several modes. Only then its modes have their own rows.
bool has_modes(const Archive& archive, const DiagnosticsRow& row) {
  return std::any_of(archive.diagnostics.begin(), archive.diagnostics.end(), [&row](const DiagnosticsRow& other) {
    return other.filter == row.filter && other.role == row.role && other.mode >= 0;
  });
}

/// Text such as "50 %: 51.2 [49.0, 53.1]; 90 %: ..."
std::string coverage_words(const DiagnosticsRow& row) {
  const auto words = [](int level, double share, double lower, double upper) {
    return fmt::format("{} %: {:.1f} [{:.1f}, {:.1f}]", level, 100 * share, 100 * lower, 100 * upper);
  };
  return fmt::format("{}, {}, {}, {}", words(50, row.coverage_50, row.coverage_50_lower, row.coverage_50_upper),
                     words(90, row.coverage_90, row.coverage_90_lower, row.coverage_90_upper),
                     words(95, row.coverage_95, row.coverage_95_lower, row.coverage_95_upper),
                     words(99, row.coverage_99, row.coverage_99_lower, row.coverage_99_upper));
}

/// The verdict on each filter's stated uncertainty, with its numbers and what is unusual.
std::string verdicts_text(const Archive& archive) {
  std::string text;
  const Role role = judged_role(archive);
  for (const DiagnosticsRow& row : archive.diagnostics) {
    if (row.mode >= 0 || row.role != role) continue;
    text += fmt::format("{:<11} {:<14} in its bands: {}\n", row.filter, name_of(row.verdict), coverage_words(row));
    text += fmt::format("{:>11} too far {:.1f} %, too close {:.1f} %; ", "", 100 * row.too_far, 100 * row.too_close);
    text += fmt::format("mean NIS {}", fixed_or_short(row.nis_mean, 3));
    if (has_modes(archive, row)) text += fmt::format("; mean entropy {}", fixed_or_short(row.entropy, 3));
    if (!std::isnan(row.nees_mean)) text += fmt::format("; NEES {}", fixed_or_short(row.nees_mean, 3));
    if (row.state_rmse.size() > 0 && row.state_rmse.allFinite())
      text += fmt::format("; state RMSE {:.4g}", fmt::join(row.state_rmse, " "));
    text += row.flags.empty() ? "\n" : fmt::format("\n{:>11} {}\n", "", row.flags);
  }
  if (text.empty()) return "";
  return fmt::format(
      "\nStated uncertainty on {} runs: percent of the samples inside the 50, 90, 95 and 99 % bands (92.5 to 97.5 %\n"
      "in the 95 % band passes). Brackets hold 95 % intervals. Entropy of the mode probabilities: 0 one mode at a "
      "time,\n"
      "1 all alike.\n{}",
      words_for(role), text);
}

/// The mean weight of each filter, one line per horizon: "combined, 10 steps ahead: bank 2 %, drifting 56 %".
std::string combination_text(const Archive& archive, Role role) {
  std::string text;
  Index horizon = 0;
  for (const CombinationRow& row : archive.combination) {
    if (row.role != role) continue;
    text +=
        row.horizon == horizon ? "," : fmt::format("{}combined, {} steps ahead:", horizon > 0 ? "\n" : "", row.horizon);
    text += fmt::format(" {} {:.0f} %", row.filter, 100 * row.weight);
    horizon = row.horizon;
  }
  return text.empty() ? "" : text + "\n";
}

/// Scores of predictions several samples ahead, on held-out runs if there are any.
std::string horizon_text(const Archive& archive) {
  if (archive.horizons.empty()) return "";
  const Role role = judged_role(archive);
  std::string text = fmt::format("\nPredictions several steps ahead, {} runs\n{:<11} {:>8} {:>8} {:>10} {:>10}\n",
                                 words_for(role), "filter", "steps", "scored", "log score", "rmse");
  for (const HorizonRow& row : archive.horizons)
    if (row.run == "*" && row.role == role)
      text += fmt::format("{:<11} {:>8} {:>8} {:>10} {:>10}\n", row.filter, row.horizon, row.samples,
                          fixed_or_short(row.log_score, 4), size_list(row.rmse, 5));
  return text + combination_text(archive, role);
}

/// The responses of all states to all inputs, a line each.
std::string responses_text(const Archive& archive, const std::string& unit) {
  if (!archive.baseline || !archive.recording) return "";
  std::string text;
  for (const std::string& words : response_words(*archive.baseline, *archive.recording, unit))
    text += "          " + words + "\n";
  return text;
}

std::string finding_text(const Archive& archive) { return archive.finding ? "\n" + archive.finding->text + "\n" : ""; }

}  // namespace

std::string data_text(const Recording& recording) {
  const auto count = [&](Role role) {
    return std::count_if(recording.runs.begin(), recording.runs.end(),
                         [role](const Trajectory& t) { return t.role == role; });
  };
  return fmt::format("data      {} training and {} held-out {}, {} and {} steps, sample period {:.4g} s\n",
                     count(Role::train), count(Role::test), noun_of_runs(2, are_stretches(recording)),
                     recording.transitions(Role::train), recording.transitions(Role::test),
                     recording.median_period_s());
}

std::string summary_text(const Archive& archive, const std::string& unit, int width) {
  std::string text;
  if (archive.recording) text += data_text(*archive.recording);
  if (archive.lag) text += lag_text(*archive.lag);
  if (archive.structure) text += structure_text(*archive.structure, acted_on(archive), width);
  text += responses_text(archive, unit);
  if (archive.windows) {
    WindowCounts counts;
    counts.add(*archive.windows);
    text += windows_text(*archive.windows, counts, window_labels(archive));
    if (const std::string noise = sensor_noise_words(archive); !noise.empty()) text += "          " + noise + "\n";
  }
  if (archive.mixture) text += mixture_text(archive);
  if (archive.bank) {
    text += bank_text(*archive.bank);
    if (archive.learned_transitions > 0 && archive.recording)
      text += fmt::format("learned   {}\n",
                          learned_words(archive.learned_transitions, archive.recording->transitions(Role::train)));
    if (const std::string warning = refinement_warning(archive.measured_fit); !warning.empty())
      text += "          warning: " + warning + "\n";
  }
  if (!archive.summary.empty())
    text += "\n" + scores_text(archive, width) + verdicts_text(archive) + confusion_text(archive, width) +
            horizon_text(archive) + finding_text(archive);
  return wrapped(text, width);
}

std::string provenance_text(const Archive& archive) {
  const Provenance& p = archive.provenance;
  std::string text = fmt::format("modebank  {} on {}\ncommand   {}\nconfig    {}\ndata      {}\nbuilt     ",
                                 p.modebank_version, p.created, p.command_line, p.config_hash, p.data_hash);
  for (const auto& [name, version] : p.versions) text += fmt::format("{} {}  ", name, version);
  return text + fmt::format("\ninputs    {} files\n", p.inputs.size());
}

}  // namespace modebank::app
