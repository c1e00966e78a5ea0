#include "filter/judge/finding.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "filter/step/combined_filter.hpp"

namespace modebank {

namespace {

using Eigen::Index;

constexpr Index free_run_horizon = 0;
constexpr double noticeable_rmse = 1e-3;  // smallest relative difference of two RMSE that counts; it is visible in a
                                          // table with three digits
constexpr double rounding_rmse = 1e-8;    // limit of an RMSE that is only rounding, as a share of a state's standard
                                          // deviation; half of a double's digits

// samples; 60 systems with modes had stays of at least 8.4 samples, systems without modes 1.6 samples
constexpr double fewest_stay = 5.0;

Index scored_runs(const Densities& densities) {
  return std::count_if(densities.of_runs.begin(), densities.of_runs.end(),
                       [](const Eigen::VectorXd& run) { return (!run.array().isNaN()).any(); });
}

/// The first of `all` that has this name; null if there is none.
template <class Named>
const Named* named(const std::vector<Named>& all, std::string Named::*name, const std::string& wanted) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Named& one) { return one.*name == wanted; });
  return found == all.end() ? nullptr : &*found;
}

const PairedGain* gain_over(const Finding& finding, const std::string& competitor) {
  return named(finding.gains, &PairedGain::competitor, competitor);
}

/// Finds the competitor with the highest score. The bank gains least over this competitor.
void set_best_competitor(Finding& finding) {
  finding.gain = finding.standard_error = not_a_number;
  for (const PairedGain& gain : finding.gains) {
    if (std::isnan(gain.gain) || finding.gain <= gain.gain) continue;
    finding.best_competitor = gain.competitor;
    finding.gain = gain.gain;
    finding.standard_error = gain.standard_error;
  }
}

/// Whether the gain of `better` over another description is negligible or insignificant.
bool is_as_good(const PairedGain& of_better) {
  if (of_better.gain < negligible_gain) return true;
  return std::isfinite(of_better.margin) && !of_better.exceeds() && !of_better.ranks_tell();
}

/// Finds the simplest competitor that is as good as the best competitor and as the bank.
void set_better_description(const std::vector<Densities>& competitors, Finding& finding) {
  const Densities* leader = named(competitors, &Densities::filter, finding.best_competitor);
  for (const char* name : competitor_names) {
    const Densities* candidate = named(competitors, &Densities::filter, name);
    if (finding.best_competitor == name) break;  // the remaining competitors are less simple
    if (!leader || !candidate) continue;
    const PairedGain loss = paired_gain(name, leader->of_runs, candidate->of_runs);
    if (!is_as_good(*gain_over(finding, name)) || !is_as_good(loss)) continue;
    finding.better_description = name;
    return;
  }
  const PairedGain* over = gain_over(finding, finding.best_competitor);
  if (over && is_as_good(*over)) finding.better_description = finding.best_competitor;
}

/// Whether a gain is significant and not negligible.
bool is_beaten(const PairedGain& over) { return over.told() && over.gain >= negligible_gain; }

/// Whether the bank is significantly better than the best competitor.
bool beats_the_best(const Finding& finding) {
  const PairedGain* gain = gain_over(finding, finding.best_competitor);
  return gain && is_beaten(*gain);
}

bool repeats(const Resolution& state) { return state.repeated > repeated_share; }

/// The answer by scores, if lags and time steps allow an answer.
Answer answer_by_scores(const Finding& finding) {
  if (finding.modes < 2 || finding.without_noise) return Answer::one_mode;
  if (!finding.repeating.empty()) return Answer::not_comparable;
  if (finding.gains.empty() || !finding.held_out()) return Answer::cannot_tell;
  const auto any = [&](auto holds) { return std::any_of(finding.gains.begin(), finding.gains.end(), holds); };
  if (any([](const PairedGain& gain) { return gain.gain + gain.margin < negligible_gain; })) return Answer::no_evidence;
  if (any([](const PairedGain& gain) { return !std::isfinite(gain.margin); })) return Answer::cannot_tell;
  if (any([](const PairedGain& gain) { return !is_beaten(gain); })) return Answer::cannot_tell;
  return finding.stay < finding.stay_asked ? Answer::cannot_tell : Answer::evidence;
}

/// The answer. While lags are missing, gains over competitors do not prove modes.
Answer answer_of(const Finding& finding) {
  if (finding.step_scatter > most_step_scatter) return Answer::not_yet;
  const Answer answer = answer_by_scores(finding);
  const bool by_gains = answer == Answer::evidence || answer == Answer::no_evidence ||
                        (answer == Answer::cannot_tell && finding.held_out());
  return by_gains && finding.pattern.told() ? Answer::not_yet : answer;
}

/// Mean stay of the bank in a mode: 1 / (rate of leaving the mode). If transition probabilities depend on the state,
/// this rate is not constant. The stay then comes from the most probable sequence of modes.
double stay_of(const FindingInputs& in) {
  const bool by_sequence = !in.bank.transition_logit.empty();
  double used = 0.0, left = 0.0;
  for (const DiagnosticsRow& row : in.diagnostics) {
    if (row.filter != "bank" || row.role != in.role || row.mode < 0) continue;
    const double stay = by_sequence ? row.dwell : row.dwell_model;
    used += row.usage;
    left += stay > 0.0 ? row.usage / stay : 0.0;
  }
  return left > 0.0 ? used / left : not_a_number;
}

Description description_of(const Finding& finding) {
  const std::string& simpler = finding.better_description;
  if (finding.answer == Answer::not_yet || finding.answer == Answer::not_comparable) return Description::none;
  if (finding.answer == Answer::evidence) return Description::several_modes;
  if (simpler.empty() && finding.answer != Answer::one_mode) return Description::none;
  if (simpler == "nonlinear") return Description::one_nonlinear_motion;
  return simpler == "drifting" ? Description::one_drifting_motion : Description::one_linear_motion;
}

/// Whether the errors of one linear model are only the rounding of the data.
bool leaves_rounding(const FindingInputs& in) {
  for (const SummaryRow& row : in.summary) {
    if (row.filter != "baseline" || row.run != "*" || row.role != in.role) continue;
    bool all = row.rmse.size() == std::ssize(in.states) && row.rmse.size() > 0;
    for (Index i = 0; all && i < row.rmse.size(); ++i)
      all = row.rmse(i) < rounding_rmse * in.states[static_cast<std::size_t>(i)].sd;
    return all;
  }
  return false;
}

/// The competitor with the smallest RMSE at each horizon and state, if this RMSE is below that of the bank. Free runs
/// come last, because they look furthest ahead.
std::vector<BetterMean> better_means(const FindingInputs& in) {
  struct Errors {
    std::string filter;
    Index horizon;
    Eigen::VectorXd rmse;
  };
  std::vector<Errors> all;
  const auto add = [&](const auto& row, Index horizon) {
    if (row.run == "*" && row.role == in.role && row.filter != combined_name)
      all.push_back({row.filter, horizon, row.rmse});
  };
  for (const SummaryRow& row : in.summary) add(row, 1);
  for (const HorizonRow& row : in.horizons)
    if (row.horizon > 1) add(row, row.horizon);
  for (const FreeRunRow& row : in.free_runs) add(row, free_run_horizon);
  std::vector<BetterMean> result;
  for (const Errors& bank : all)
    for (Index i = 0; i < bank.rmse.size() && bank.filter == "bank"; ++i) {
      BetterMean least{"", bank.horizon, "", bank.rmse(i), (1.0 - noticeable_rmse) * bank.rmse(i)};
      for (const Errors& other : all) {
        if (other.filter == "bank" || other.horizon != bank.horizon || !(other.rmse(i) < least.rmse)) continue;
        least.competitor = other.filter;
        least.rmse = other.rmse(i);
      }
      if (in.states.size() > 1) least.state = in.states[static_cast<std::size_t>(i)].state;
      if (!least.competitor.empty()) result.push_back(least);
    }
  return result;
}

}  // namespace

const char* description_of(const std::string& competitor) {
  if (competitor == "baseline") return "one linear model with constant noise";
  if (competitor == "noise_only" || competitor == "one_motion") return "one linear model with changing noise";
  if (competitor == "drifting") return "one linear model whose parameters wander";
  if (competitor == "nonlinear") return "one nonlinear model";
  return "";
}

Doubt doubt_of(const Finding& finding) {
  if (!finding.held_out()) return Doubt::nothing_held_out;
  if (finding.gains.empty()) return Doubt::no_competitor;
  if (!least_beaten(finding)) return Doubt::few_samples;
  const PairedGain& least = *least_beaten(finding);
  if (!least.told()) return Doubt::within_chance;
  return least.gain < negligible_gain ? Doubt::small_gain : Doubt::short_stays;
}

const PairedGain* least_beaten(const Finding& finding) {
  const auto comes_before = [](const PairedGain& a, const PairedGain& b) {
    if (a.told() != b.told()) return b.told();
    const bool a_counts = a.gain >= negligible_gain, b_counts = b.gain >= negligible_gain;
    return a_counts != b_counts ? b_counts : a.gain * b.margin < b.gain * a.margin;
  };
  const PairedGain* least = nullptr;
  for (const PairedGain& gain : finding.gains) {
    if (!std::isfinite(gain.margin)) return nullptr;
    if (!least || comes_before(gain, *least)) least = &gain;
  }
  return least;
}

Finding judge_modes(const FindingInputs& in) {
  Finding finding;
  finding.role = in.role;
  finding.runs = scored_runs(in.bank_densities);
  finding.modes = in.bank.mode_count();
  finding.step_scatter = in.step_scatter;
  finding.pattern = in.pattern;
  finding.stay = stay_of(in);
  finding.stay_asked = std::max(fewest_stay, static_cast<double>(in.bank.structure.first_transition() + 1));
  finding.without_noise = leaves_rounding(in);
  std::copy_if(in.states.begin(), in.states.end(), std::back_inserter(finding.repeating), repeats);
  for (const Densities& competitor : in.competitors)
    finding.gains.push_back(paired_gain(competitor.filter, in.bank_densities.of_runs, competitor.of_runs));
  set_best_competitor(finding);
  finding.answer = answer_of(finding);
  const bool densities_tell =
      finding.answer != Answer::not_comparable && finding.answer != Answer::not_yet && !finding.without_noise;
  if (densities_tell && !beats_the_best(finding)) set_better_description(in.competitors, finding);
  finding.description = description_of(finding);
  if (finding.modes > 1 && !finding.without_noise) finding.better_means = better_means(in);
  return finding;
}

}  // namespace modebank
