#include "app/study/run/study_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <numeric>

#include "io/files/read_file.hpp"

namespace modebank::app {
namespace {

/// What a plan's runs took so far.
struct MadeRuns {
  StudyPlan plan;  ///< the whole plan without the rows that were not made
  std::array<double, stage_count> stage_seconds{};
  double seconds = 0.0, shortest = std::numeric_limits<double>::infinity(), longest = 0.0;
  std::size_t imports = 0;  ///< times that data were read
  std::size_t count() const { return plan.table.rows.size(); }
};

/// The seconds of a run and of its stages in a line of the log; none: the run was not done, or the line is torn.
std::vector<double> seconds_in(const std::string& line, std::string& key) {
  static const std::string done = ",done,";
  const auto word = line.find(done);
  if (word == std::string::npos) return {};
  key = line.substr(line.rfind(',', word - 1) + 1, word - line.rfind(',', word - 1) - 1);
  std::vector<double> seconds;
  const char* at = line.c_str() + word + done.size();
  for (char* end = nullptr; seconds.size() <= stage_count; at = end + 1) {
    seconds.push_back(std::strtod(at, &end));
    if (end == at || *end != ',' || !std::isfinite(seconds.back())) return {};
  }
  return seconds;
}

MadeRuns made_runs(const TrialStore& store, const StudyPlan& plan) {
  MadeRuns made{plan, {}, 0.0, std::numeric_limits<double>::infinity(), 0.0, 0};
  made.plan.table.rows.clear();
  std::map<std::string, const TrialRow*> planned;
  for (const TrialRow& row : plan.table.rows)
    if (row.status != TrialStatus::dropped) planned[row.key] = &row;
  refuse_special_file(store.log());
  std::ifstream file(store.log());
  std::string key;
  for (std::string line; std::getline(file, line);) {
    const std::vector<double> seconds = seconds_in(line, key);
    const auto row = planned.find(key);
    if (seconds.empty() || row == planned.end()) continue;
    made.plan.table.rows.push_back(*row->second);
    made.seconds += seconds[0];
    made.shortest = std::min(made.shortest, seconds[0]);
    made.longest = std::max(made.longest, seconds[0]);
    for (std::size_t i = 0; i < stage_count; ++i) made.stage_seconds[i] += seconds[i + 1];
    made.imports += seconds[1] > 0.0;
  }
  return made;
}

/// Bytes of all archives that are there, and how many are.
std::pair<double, std::size_t> archives_of(const TrialStore& store, const StudyPlan& plan) {
  double sum = 0.0;
  std::size_t archives = 0;
  for (const TrialRow& row : plan.table.rows) {
    std::error_code absent;
    const auto bytes = row.key.empty() ? 0 : std::filesystem::file_size(store.archive(row.key), absent);
    if (absent || row.key.empty()) continue;
    sum += static_cast<double>(bytes);
    ++archives;
  }
  return {sum, archives};
}

std::size_t planned(const StudyPlan& plan) {
  std::size_t count = 0;
  for (const TrialRow& row : plan.table.rows) count += row.status != TrialStatus::dropped;
  return count;
}

/// Some runs of the plan that have nothing in common but chance: hashes know no order of values. Those that share
/// stages stay together.
TrialGroups sample_of(const Config& study, const StudyPlan& plan, std::size_t jobs) {
  std::vector<std::string> keys;
  for (const TrialRow& row : plan.table.rows)
    if (row.status != TrialStatus::dropped) keys.push_back(row.key);
  constexpr std::size_t one_in = 10, most = 8;
  const std::size_t wanted = std::clamp<std::size_t>(keys.size() / one_in, 1, std::max(most, jobs));
  std::sort(keys.begin(), keys.end());
  TrialGroups sample;
  for (const auto& group : group_trials(study, plan)) {
    sample.emplace_back();
    for (const std::size_t row : group)
      if (plan.table.rows[row].key <= keys[wanted - 1]) sample.back().push_back(row);
    if (sample.back().empty()) sample.pop_back();
  }
  return sample;
}

/// Seconds of the whole plan, one run at a time.
double scaled_seconds(const Config& study, const StudyPlan& plan, const MadeRuns& made, std::size_t jobs) {
  const auto of = [&](Stage stage) { return made.stage_seconds[index_of(stage)]; };
  const DistinctStages all = count_stages(study, plan), there = count_stages(study, made.plan);
  const auto times = [](std::size_t n, std::size_t m) {
    return static_cast<double>(n) / static_cast<double>(std::max<std::size_t>(m, 1));
  };
  const double shared = std::accumulate(made.stage_seconds.begin(), made.stage_seconds.end(), 0.0);
  using enum Stage;
  return times(jobs, made.imports) * of(data) +
         times(all.windows, there.windows) * (of(windows) + of(competitors) + of(competitor_scores)) +
         times(all.mixtures, there.mixtures) * of(mixture) + times(all.banks, there.banks) * of(bank) +
         times(planned(plan), made.count()) * (made.seconds - shared + of(bank_scores));
}

std::string basis_of(const MadeRuns& made, bool now) {
  const std::string range = made.count() == 1 ? fmt::format("{:.2g} s", made.longest)
                                              : fmt::format("{:.2g} to {:.2g} s each", made.shortest, made.longest);
  return fmt::format("from {} run{} made {}, {}; stages that runs share count once", made.count(),
                     made.count() == 1 ? "" : "s", now ? "now" : "before", range);
}

}  // namespace

StudyEstimate estimate_study(const WorkerSettings& settings, const StudyPlan& plan, Sampling sampling) {
  StudyEstimate estimate;
  const std::size_t runs = planned(plan), jobs = job_count(settings.config.study);
  const bool none = runs > 0 && archives_of(settings.store, plan).second == 0;
  const bool now = none && sampling == Sampling::make_some_runs;
  if (now)
    run_trials(settings, plan, sample_of(settings.config, plan, jobs),
               [](const TrialRow&, const TrialReport&, std::size_t, std::size_t) {});
  const auto [bytes, archives] = archives_of(settings.store, plan);
  const MadeRuns made = made_runs(settings.store, plan);
  estimate.left = runs - archives;
  estimate.known = archives > 0 && made.count() > 0;
  if (estimate.known)
    estimate.basis = basis_of(made, now);
  else if (none && !now)
    estimate.basis = "how long is unknown: none was made yet; --study.estimate true makes some here";
  else
    estimate.basis = "how long is unknown: no run that succeeded was measured";
  if (!estimate.known) return estimate;
  const double part_left = static_cast<double>(estimate.left) / static_cast<double>(runs);
  estimate.seconds =
      scaled_seconds(settings.config, plan, made, jobs) * part_left / static_cast<double>(std::min(jobs, runs));
  estimate.bytes = bytes / static_cast<double>(archives) * static_cast<double>(estimate.left);
  return estimate;
}

}  // namespace modebank::app
