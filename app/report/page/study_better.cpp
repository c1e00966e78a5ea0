#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "app/report/page/numbers.hpp"
#include "app/report/page/paired_runs.hpp"
#include "app/report/page/study_page.hpp"
#include "ident/base/distributions.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;
using Rows = std::vector<std::size_t>;

constexpr std::size_t most_rivals = 8;
constexpr double upper_probability = 0.975;

/// Finished settings that have a score. They are ordered by the mean over their repeats, the best first.
std::vector<Rows> ranked_settings(const StudyTable& table, std::size_t score, const ScoreGoal& goal) {
  std::map<std::vector<std::string>, Rows> by_values;
  std::vector<std::vector<std::string>> order;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const TrialRow& row = table.rows[i];
    if (row.status != TrialStatus::done || std::isnan(row.scores[score])) continue;
    Rows& rows = by_values[row.varied];
    if (rows.empty()) order.push_back(row.varied);
    rows.push_back(i);
  }
  std::vector<std::pair<double, Rows>> settings;
  for (const auto& values : order) {
    const Rows& rows = by_values[values];
    double sum = 0.0;
    for (const std::size_t row : rows) sum += table.rows[row].scores[score];
    settings.emplace_back(goal.loss(sum / static_cast<double>(rows.size())), rows);
  }
  std::stable_sort(settings.begin(), settings.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Rows> ranked;
  for (auto& [loss, rows] : settings) ranked.push_back(std::move(rows));
  return ranked;
}

/// The archive of a row; nullopt if it is missing or unreadable.
std::optional<Archive> archive_of(const TrialPlace& place) {
  if (place.archive.empty()) return {};
  try {
    return read_archive(place.archive, Evaluations::in_file);
  } catch (const std::exception&) {
    return {};
  }
}

/// differences in log score below this do not matter for a choice [nats/sample]
constexpr double no_matter = 0.001;

std::string calibration_of(double gain, double margin) {
  if (std::abs(gain) < no_matter && !(margin >= no_matter)) return "the same";
  if (!std::isfinite(margin)) return "error not known";
  return gain > margin ? "worse" : gain < -margin ? "better" : "cannot tell";
}

nlohmann::json gain_cell(double gain, double error) {
  if (!std::isfinite(gain)) return number(gain);
  return number(gain,
                std::isfinite(error) ? fmt::format("{:+.4f} ± {:.4f}", gain, error) : fmt::format("{:+.4f}", gain));
}

/// Gain of the best setting over a rival, and what its standard error is based on.
struct JudgedGain {
  double gain, standard_error, margin;
  std::string by;
};

JudgedGain judged(const ArchiveGain& by_run, const RepeatGain& by_repeat) {
  const std::string repeats = fmt::format("{} repeats", by_repeat.repeats);
  if (by_run.runs == 0)
    return {by_repeat.gain, by_repeat.standard_error, by_repeat.margin,
            by_repeat.repeats < 2 ? "there are no pairs" : repeats};
  const PairedGain& first = by_run.gain;
  const std::string runs = first.by_blocks ? "stretches of runs" : fmt::format("{} runs", by_run.runs);
  if (by_repeat.repeats < 2) return {first.gain, first.standard_error, first.margin, runs};
  // The best setting has the best mean over repeats. Its first repeat alone may be worse than the rival's.
  return {by_repeat.gain, std::hypot(first.standard_error, by_repeat.standard_error),
          std::hypot(first.margin, by_repeat.margin), runs + " and " + repeats};
}

json row_json(const StudyTable& table, std::size_t row, const JudgedGain& gain) {
  return {{"row", row},
          {"varied", table.rows[row].varied},
          {"gain", gain_cell(gain.gain, gain.standard_error)},
          {"margin",
           std::isfinite(gain.margin) ? number(gain.margin, fmt::format("{:.4f}", gain.margin)) : number(gain.margin)},
          {"verdict", calibration_of(gain.gain, gain.margin)},
          {"by", gain.by}};
}

}  // namespace

RepeatGain repeat_gain(const StudyTable& table, const Rows& best, const Rows& other, std::size_t score) {
  std::vector<double> differences;
  for (const std::size_t a : best)
    for (const std::size_t b : other)
      if (table.rows[a].repeat == table.rows[b].repeat)
        differences.push_back(table.rows[a].scores[score] - table.rows[b].scores[score]);
  RepeatGain gain{std::ssize(differences)};
  if (differences.empty()) return gain;
  const Eigen::Map<const Eigen::VectorXd> d(differences.data(), gain.repeats);
  gain.gain = d.mean();
  if (gain.repeats < 2) return gain;
  const auto R = static_cast<double>(gain.repeats);
  gain.standard_error = std::sqrt((d.array() - gain.gain).square().sum() / (R - 1.0) / R);
  gain.margin = student_quantile(upper_probability, R - 1.0) * gain.standard_error;
  return gain;
}

nlohmann::json better_section(const StudyTable& table, const std::vector<TrialPlace>& places,
                              const std::string& headline) {
  const auto found = std::find(table.score_names.begin(), table.score_names.end(), headline);
  if (found == table.score_names.end()) return nullptr;
  const auto score = static_cast<std::size_t>(found - table.score_names.begin());
  const std::vector<Rows> settings = ranked_settings(table, score, goal_of(headline, 1).value());
  if (settings.size() < 2) return nullptr;
  const std::optional<Archive> best = archive_of(places[settings[0].front()]);
  json rivals = json::array();
  for (std::size_t s = 1; s < std::min(settings.size(), most_rivals + 1); ++s) {
    const std::size_t row = settings[s].front();
    const std::optional<Archive> other = best ? archive_of(places[row]) : std::nullopt;
    const ArchiveGain by_run = other ? gain_between(*best, *other) : ArchiveGain();
    rivals.push_back(row_json(table, row, judged(by_run, repeat_gain(table, settings[0], settings[s], score))));
  }
  return {{"best", settings[0].front()}, {"settings", settings.size()}, {"rivals", rivals}};
}

}  // namespace modebank::app::report
