#include "app/text/screen_facts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cstdlib>

#include "app/text/calibration_text.hpp"
#include "app/text/judged_runs.hpp"
#include "app/text/number_text.hpp"
#include "app/text/operating_point.hpp"
#include "app/text/response_text.hpp"
#include "app/text/structure_text.hpp"
#include "app/text/warnings.hpp"
#include "filter/step/combined_filter.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank::app {
namespace {

/// Time by which the inputs act later than recorded. It is estimated, or stated in the configuration.
double input_lag(const Archive& archive, const Settings& settings) {
  if (archive.lag) return archive.lag->correction == LagCorrection::none ? 0.0 : archive.lag->lag.mean;
  const auto stated = settings.find("data.lag_s");
  return stated == settings.end() ? 0.0 : std::atof(stated->second.c_str());
}

/// Text such as "wz [rad/s], v [m/s]".
std::string channel_words(const std::vector<Channel>& channels) {
  std::vector<std::string> words;
  for (const Channel& channel : channels)
    words.push_back(channel.unit.empty() ? channel.name : fmt::format("{} [{}]", channel.name, channel.unit));
  return boost::algorithm::join(words, ", ");
}

std::string lag_words(double lag_s, const Recording& recording) {
  const std::string states = fmt::format("{}", fmt::join(names_of(recording.states), ", "));
  return lag_s < 0.0 ? fmt::format(
                           "the stamps of the inputs are {0:.3f} s late, so when filtering live delay {1} by "
                           "{0:.3f} s",
                           -lag_s, states)
                     : fmt::format("the inputs act {:.3f} s after their stamps", lag_s);
}

std::string read_words(const Archive& archive, const Settings& settings) {
  if (!archive.recording) return "";
  const Recording& recording = *archive.recording;
  const auto runs = [&](Role role) {
    const auto count = std::count_if(recording.runs.begin(), recording.runs.end(),
                                     [role](const Trajectory& t) { return t.role == role; });
    return fmt::format("{} {} {} ({} steps)", count, words_for(role), noun_of_runs(count, are_stretches(recording)),
                       recording.transitions(role));
  };
  const Index steps = recording.transitions(Role::train);
  const bool held_out = std::any_of(recording.runs.begin(), recording.runs.end(),
                                    [](const Trajectory& t) { return t.role == Role::test; });
  const std::string period =
      time_unit(settings) == "s" ? fmt::format("steps of {:.3g} s", recording.median_period_s()) : "without times";
  std::string text =
      fmt::format("{}{}, {}; the models predict {}", runs(Role::train),
                  held_out ? " and " + runs(Role::test) : ", none held out", period, channel_words(recording.states));
  if (!recording.inputs.empty()) text += " from " + channel_words(recording.inputs);
  if (const double lag_s = input_lag(archive, settings); lag_s != 0.0) text += "; " + lag_words(lag_s, recording);
  if (archive.learned_transitions > 0)
    text += fmt::format("; the bank learned {}", learned_words(archive.learned_transitions, steps));
  if (archive.mixture && archive.mixture->compared > 0)
    text += fmt::format("; mixtures were compared on {} windows",
                        of_all(archive.mixture->compared, archive.mixture->clustered));
  return text;
}

const FreeRunRow* free_run_of(const Archive& archive, const std::string& filter, Role role) {
  const auto found = std::find_if(archive.free_runs.begin(), archive.free_runs.end(), [&](const FreeRunRow& row) {
    return row.filter == filter && row.role == role && row.run == "*";
  });
  return found == archive.free_runs.end() ? nullptr : &*found;
}

/// The filter whose free run stands for `filter`. The combination needs measurements, so that of the single filter with
/// the highest score in free runs of the training runs.
std::string simulating_filter(const Archive& archive, const std::string& filter) {
  const FreeRunRow* best = nullptr;
  for (const FreeRunRow& row : archive.free_runs)
    if (row.role == Role::train && row.run == "*" && (!best || row.log_score > best->log_score)) best = &row;
  return filter == combined_name && best ? best->filter : filter;
}

/// Text such as "RMSE one step ahead 0.03 rad/s (1.72 deg/s), FIT 92.3 % (drifting 0.04); 10 steps ahead ...; in free
/// run from 3 samples FIT 71.2 % (...)". `simulating`: the filter of the free run, named where it is another one.
std::string mean_words(const FirstScreen& screen, const std::string& simulating) {
  const auto beside = [](const std::string& words) { return words.empty() ? "" : fmt::format(" ({})", words); };
  std::vector<std::string> parts;
  for (const ErrorAhead& error : screen.errors)
    parts.push_back(
        (error.steps == 1 ? std::string("RMSE one step ahead ") : fmt::format("{} steps ahead ", error.steps)) +
        error.words + beside(error.other_words));
  if (screen.free_run_start > 0)
    parts.push_back(fmt::format("in free run{} from {} samples FIT {}{}",
                                simulating == screen.filter ? "" : " of " + simulating, screen.free_run_start,
                                fit_words(screen.fit), beside(screen.other_fit_words)));
  return screen.errors.empty() ? "" : boost::algorithm::join(parts, "; ");
}

std::string warning_words(const Archive& archive) {
  const std::vector<std::string> warnings = archive_warnings(archive);
  if (warnings.empty()) return "";
  return warnings.size() == 1 ? warnings.front()
                              : fmt::format("{} warnings (`modebank show ARCHIVE` prints all), the first: {}",
                                            warnings.size(), warnings.front());
}

/// Sets the members that contain scores. Call it after the role, the filter and the competitor are set.
void add_scores(FirstScreen& screen, const Archive& archive) {
  const std::string other = screen.filter == "bank" ? screen.competitor : "bank";
  screen.errors = errors_ahead(archive, screen.role, screen.filter, other);
  const std::string simulating = simulating_filter(archive, screen.filter);
  if (const FreeRunRow* own = free_run_of(archive, simulating, screen.role)) {
    screen.free_run_start = own->start;
    screen.fit = own->fit;
    if (const FreeRunRow* beside = free_run_of(archive, other, screen.role); beside && beside != own)
      screen.other_fit_words = fmt::format("{} {}", other, fit_words(beside->fit));
  }
  screen.mean = mean_words(screen, simulating);
  screen.coverage = screen.coverage_lower = screen.coverage_upper = not_a_number;
  if (const DiagnosticsRow* row = diagnosis(archive, screen.filter, screen.role)) {
    screen.band = band_text(*row, screen.errors);
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
  const bool switches = archive.finding && archive.finding->answer == Answer::evidence;
  if (archive.baseline && archive.recording) {
    if (const auto words = response_words(*archive.baseline, *archive.recording, time_unit(settings));
        !words.empty() && !switches)
      screen.structure += (screen.structure.empty() ? "one linear model: " : "; ") + words.front();
    screen.point = operating_words(*archive.baseline, *archive.recording);
  }
  screen.doubt = level_doubt(archive);
  screen.inputs_ahead = input_lag(archive, settings) < 0.0;
  screen.warning = warning_words(archive);
  screen.forecasts = named_forecasts(archive);
  screen.use = use_words(archive, screen.forecasts);
  screen.role = judged_role(archive);
  screen.filter = "bank";
  for (const NamedForecast& forecast : screen.forecasts)
    if (forecast.steps == 1 && pooled_row(archive, forecast.filter, screen.role)) screen.filter = forecast.filter;
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
    if (!archive.finding || archive.finding->better_description.empty() || screen.mode_count == 1)
      screen.modes = mode_table(archive, 0, time_unit(settings));
  }
  return screen;
}

}  // namespace modebank::app
