#include "app/text/screen_facts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cmath>
#include <cstdlib>
#include <functional>

#include "app/text/calibration_text.hpp"
#include "app/text/judged_runs.hpp"
#include "app/text/structure_text.hpp"
#include "app/text/warnings.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank::app {
namespace {

/// How much later than recorded inputs act: found, or said.
double input_lag(const Archive& archive, const Settings& settings) {
  if (archive.lag) return archive.lag->correction == LagCorrection::none ? 0.0 : archive.lag->lag.mean;
  const auto said = settings.find("data.lag_s");
  return said == settings.end() ? 0.0 : std::atof(said->second.c_str());
}

std::string lag_words(double lag_s) {
  return fmt::format("{:.3f} s {} than recorded", std::abs(lag_s), lag_s < 0.0 ? "earlier" : "later");
}

std::string read_words(const Archive& archive, const Settings& settings) {
  if (!archive.recording) return "";
  const Recording& recording = *archive.recording;
  const auto count = [&](Role role) {
    return std::count_if(recording.runs.begin(), recording.runs.end(),
                         [role](const Trajectory& t) { return t.role == role; });
  };
  const Index train = count(Role::train), test = count(Role::test);
  const Index steps = recording.transitions(Role::train), held_out = recording.transitions(Role::test);
  std::string text =
      test == 0 ? fmt::format("{} training run{}, none held out, {} steps", train, train == 1 ? "" : "s", steps)
                : fmt::format("{} training and {} held-out run{}, {} and {} steps", train, test, test == 1 ? "" : "s",
                              steps, held_out);
  text += fmt::format(" of {:.3g} s; {}", recording.median_period_s(), fmt::join(names_of(recording.states), ", "));
  if (!recording.inputs.empty()) text += fmt::format(" from {}", fmt::join(names_of(recording.inputs), ", "));
  if (archive.lag && archive.lag->correction != LagCorrection::none)
    text += fmt::format(", which act {}", lag_words(archive.lag->lag.mean));
  if (const double lag_s = input_lag(archive, settings); lag_s < 0.0)
    text += fmt::format("{}the filter needs inputs {:.3f} s ahead of the states", archive.lag ? ": " : "; ", -lag_s);
  if (archive.learned_transitions > 0)
    text += fmt::format("; the bank learned {}", learned_words(archive.learned_transitions, steps));
  if (archive.mixture && archive.mixture->compared > 0)
    text += fmt::format("; mixtures were compared on {} windows",
                        of_all(archive.mixture->compared, archive.mixture->clustered));
  return text;
}

/// One text per state, with its name where there are several.
std::vector<std::string> rmse_parts(const Eigen::VectorXd& rmse, const std::vector<Channel>& states) {
  std::vector<std::string> parts;
  for (Index i = 0; i < rmse.size(); ++i) {
    const Channel state = static_cast<std::size_t>(i) < states.size() ? states[static_cast<std::size_t>(i)] : Channel{};
    parts.push_back(fmt::format("{}{:.4g}{}", rmse.size() > 1 ? state.name + " " : "", rmse(i),
                                state.unit.empty() ? "" : " " + state.unit));
  }
  return parts;
}

/// "0.0301 rad/s", or per state "wz 0.0301 rad/s, v 0.2 m/s".
std::string rmse_words(const Eigen::VectorXd& rmse, const std::vector<Channel>& states) {
  return boost::algorithm::join(rmse_parts(rmse, states), ", ");
}

/// The best of several filters, state by state.
struct Best {
  Eigen::VectorXd values;
  std::vector<std::string> names;
};

const HorizonRow* horizon_row(const Archive& archive, const std::string& filter, Role role, Index horizon) {
  const auto found = std::find_if(archive.horizons.begin(), archive.horizons.end(), [&](const HorizonRow& row) {
    return row.filter == filter && row.role == role && row.run == "*" && row.horizon == horizon;
  });
  return found == archive.horizons.end() ? nullptr : &*found;
}

const HorizonRow* longest_horizon(const Archive& archive, const std::string& filter, Role role) {
  const HorizonRow* longest = nullptr;
  for (const HorizonRow& row : archive.horizons)
    if (row.filter == filter && row.role == role && row.run == "*" && row.horizon > (longest ? longest->horizon : 1))
      longest = &row;
  return longest;
}

const FreeRunRow* free_run_of(const Archive& archive, const std::string& filter, Role role) {
  const auto found = std::find_if(archive.free_runs.begin(), archive.free_runs.end(), [&](const FreeRunRow& row) {
    return row.filter == filter && row.role == role && row.run == "*";
  });
  return found == archive.free_runs.end() ? nullptr : &*found;
}

/// The competitor that is best at each state. `value_of`: a competitor's numbers, null without.
template <class ValueOf, class Better>
Best best_of_competitors(ValueOf value_of, Better better) {
  Best best;
  for (const char* name : competitor_names) {
    const Eigen::VectorXd* values = value_of(name);
    if (!values) continue;
    if (best.names.empty()) best = {*values, std::vector<std::string>(static_cast<std::size_t>(values->size()), name)};
    for (Index i = 0; i < std::min(values->size(), best.values.size()); ++i)
      if (better((*values)(i), best.values(i))) {
        best.values(i) = (*values)(i);
        best.names[static_cast<std::size_t>(i)] = name;
      }
  }
  return best;
}

/// "drifting: 0.04 rad/s", or "wz 0.04 rad/s (drifting), v 0.2 m/s (baseline)" where states differ in it.
std::string words_of_best(const Best& best, const std::string& together, const std::vector<std::string>& each) {
  if (best.names.empty()) return "";
  if (std::adjacent_find(best.names.begin(), best.names.end(), std::not_equal_to<>()) == best.names.end())
    return fmt::format("{}: {}", best.names.front(), together);
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < each.size(); ++i) parts.push_back(fmt::format("{} ({})", each[i], best.names[i]));
  return boost::algorithm::join(parts, ", ");
}

/// The bank's row of a number of steps ahead with what is beside it. `row_of`: of a filter, null without.
template <class RowOf>
void add_error(Index steps, RowOf row_of, const Archive& archive, std::vector<ErrorAhead>& errors) {
  const auto* bank = row_of("bank");
  if (!bank) return;
  const std::vector<Channel> states = archive.recording ? archive.recording->states : std::vector<Channel>();
  const auto value_of = [&](const char* name) { return row_of(name) ? &row_of(name)->rmse : nullptr; };
  const Best other = best_of_competitors(value_of, std::less<>());
  const auto* row = row_of(combined_name);
  const Eigen::VectorXd combined = row ? row->rmse : Eigen::VectorXd();
  errors.push_back({steps, bank->rmse, other.values, combined, rmse_words(bank->rmse, states),
                    words_of_best(other, rmse_words(other.values, states), rmse_parts(other.values, states)),
                    rmse_words(combined, states)});
}

/// One step ahead, and as far as was looked ahead.
std::vector<ErrorAhead> errors_ahead(const Archive& archive, Role role) {
  std::vector<ErrorAhead> errors;
  add_error(
      1, [&](const char* filter) { return pooled_row(archive, filter, role); }, archive, errors);
  if (const HorizonRow* far = longest_horizon(archive, "bank", role))
    add_error(
        far->horizon, [&](const char* filter) { return horizon_row(archive, filter, role, far->horizon); }, archive,
        errors);
  return errors;
}

}  // namespace

std::string fit_words(const Eigen::VectorXd& fit) {
  std::vector<std::string> parts;
  for (const double share : fit) parts.push_back(fmt::format("{:.1f} %", share));
  return boost::algorithm::join(parts, ", ");
}

namespace {

/// "RMSE one step ahead 0.03 rad/s (drifting: 0.04 rad/s); 10 steps ahead ...; free run from 3 samples FIT 71.2 %
/// (...)"
std::string mean_words(const FirstScreen& screen) {
  const auto beside = [&](const std::string& words, const std::string& combined = "") {
    std::vector<std::string> others;
    if (!words.empty()) others.push_back(words);
    if (!combined.empty()) others.push_back(fmt::format("combined: {}", combined));
    return others.empty() ? "" : fmt::format(" ({})", boost::algorithm::join(others, ", "));
  };
  std::vector<std::string> parts;
  for (const ErrorAhead& error : screen.errors)
    parts.push_back(
        (error.steps == 1 ? std::string("RMSE one step ahead ") : fmt::format("{} steps ahead ", error.steps)) +
        error.bank_words + beside(error.other_words, error.combined_words));
  if (screen.free_run_start > 0)
    parts.push_back(fmt::format("free run from {} samples FIT {}{}", screen.free_run_start, fit_words(screen.fit),
                                beside(screen.other_fit_words)));
  return screen.errors.empty() ? "" : boost::algorithm::join(parts, "; ");
}

std::string warning_words(const Archive& archive) {
  const std::vector<Warning> warnings = archive_warnings(archive);
  if (warnings.empty()) return "";
  return warnings.size() == 1
             ? warnings.front().text
             : fmt::format("{}, the first: {} (`modebank show` has all)", warnings.size(), warnings.front().text);
}

/// The numbers of the scores; `screen` has its role already.
void add_scores(FirstScreen& screen, const Archive& archive) {
  screen.errors = errors_ahead(archive, screen.role);
  if (const FreeRunRow* bank = free_run_of(archive, "bank", screen.role)) {
    screen.free_run_start = bank->start;
    screen.fit = bank->fit;
    const auto fit_of = [&](const char* name) {
      const FreeRunRow* row = free_run_of(archive, name, screen.role);
      return row ? &row->fit : nullptr;
    };
    const Best other = best_of_competitors(fit_of, std::greater<>());
    screen.other_fit = other.values;
    std::vector<std::string> each;
    for (const double fit : other.values) each.push_back(fmt::format("{:.1f} %", fit));
    screen.other_fit_words = words_of_best(other, fit_words(other.values), each);
  }
  screen.mean = mean_words(screen);
  screen.coverage = screen.coverage_lower = screen.coverage_upper = not_a_number;
  if (const DiagnosticsRow* row = diagnosis(archive, "bank", screen.role)) {
    screen.band = band_text(*row);
    screen.verdict_words = verdict_text(*row);
    screen.verdict = row->verdict;
    screen.coverage = row->coverage_95;
    screen.coverage_lower = row->coverage_95_lower;
    screen.coverage_upper = row->coverage_95_upper;
  }
}

}  // namespace

std::string answer_words(Answer answer) {
  switch (answer) {
    case Answer::one_mode:
      return "one mode";
    case Answer::not_comparable:
      return "modes of motion cannot be judged";
    case Answer::cannot_tell:
      return "modes of motion: cannot tell";
    case Answer::no_evidence:
      return "no evidence for modes of motion";
    case Answer::evidence:
      return "evidence for modes of motion";
    case Answer::not_yet:
      return "modes of motion: not yet";
  }
  return "";
}

bool has_first_screen(const Archive& archive) { return archive.bank && !archive.summary.empty(); }

FirstScreen make_first_screen(const Archive& archive, const Settings& settings) {
  FirstScreen screen;
  screen.read = read_words(archive, settings);
  if (archive.structure) screen.structure = structure_sentence(*archive.structure, acted_on(archive));
  screen.inputs_ahead = input_lag(archive, settings) < 0.0;
  screen.warning = warning_words(archive);
  screen.next = next_step(archive, settings);
  screen.use = use_words(archive);
  screen.forecasts = named_forecasts(archive);
  screen.role = judged_role(archive);
  screen.gain = screen.gain_error = not_a_number;
  if (archive.finding) {
    const Finding& finding = *archive.finding;
    screen.finding = finding.text;
    screen.answer = finding.answer;
    screen.competitor = finding.best_competitor;
    if (!finding.best_competitor.empty()) screen.gain = finding.gain, screen.gain_error = finding.standard_error;
  }
  add_scores(screen, archive);
  if (archive.bank) {
    screen.mode_count = archive.bank->mode_count();
    screen.modes = mode_table(archive);
  }
  return screen;
}

}  // namespace modebank::app
