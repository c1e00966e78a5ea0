#include "app/study/study_estimate.hpp"

#include <fmt/format.h>

#include <fstream>
#include <numeric>

namespace modebank::app {
namespace {

/// Mean seconds of the runs that the log says were done; 0: none.
double logged_seconds(const TrialStore& store) {
  std::ifstream file(store.log());
  double sum = 0.0;
  std::size_t count = 0;
  for (std::string line; std::getline(file, line);) {
    const auto word = line.find(",done,");
    if (word == std::string::npos) continue;
    sum += std::strtod(line.c_str() + word + 6, nullptr);
    ++count;
  }
  return count == 0 ? 0.0 : sum / static_cast<double>(count);
}

double mean_bytes(const TrialStore& store, const StudyPlan& plan, std::size_t& archives) {
  double sum = 0.0;
  archives = 0;
  for (const TrialRow& row : plan.table.rows) {
    std::error_code absent;
    const auto bytes = row.key.empty() ? 0 : std::filesystem::file_size(store.archive(row.key), absent);
    if (absent || row.key.empty()) continue;
    sum += static_cast<double>(bytes);
    ++archives;
  }
  return archives == 0 ? 0.0 : sum / static_cast<double>(archives);
}

std::size_t planned(const StudyPlan& plan) {
  std::size_t count = 0;
  for (const TrialRow& row : plan.table.rows) count += row.status != TrialStatus::dropped;
  return count;
}

/// The whole plan's seconds from those of one run's stages.
double scaled_seconds(const TrialReport& report, const DistinctStages& distinct, std::size_t runs, std::size_t jobs) {
  const auto of = [&](TrialStage stage) { return report.stage_seconds[static_cast<std::size_t>(stage)]; };
  const double shared = std::accumulate(report.stage_seconds.begin(), report.stage_seconds.end(), 0.0);
  const double each = report.seconds - shared + of(TrialStage::bank_scores);
  const auto times = [](std::size_t n) { return static_cast<double>(n); };
  using enum TrialStage;
  return times(jobs) * of(data) + times(distinct.windows) * (of(windows) + of(competitors) + of(competitor_scores)) +
         times(distinct.mixtures) * of(mixture) + times(distinct.banks) * of(bank) + times(runs) * each;
}

}  // namespace

StudyEstimate estimate_study(const WorkerSettings& settings, const StudyPlan& plan) {
  StudyEstimate estimate;
  const std::size_t runs = planned(plan), jobs = job_count(settings.config.study);
  std::size_t archives = 0;
  double bytes = mean_bytes(settings.store, plan, archives);
  double seconds_each = logged_seconds(settings.store);
  estimate.basis = fmt::format("from {} runs made before", archives);
  if (archives == 0 && runs > 0) {
    TrialGroups middle{{}};
    std::size_t seen = 0;
    for (std::size_t row = 0; row < plan.table.rows.size(); ++row)
      if (plan.table.rows[row].status != TrialStatus::dropped && seen++ == runs / 2) middle[0].push_back(row);
    TrialReport measured;
    run_trials(settings, plan, middle,
               [&](const TrialRow&, const TrialReport& report, std::size_t, std::size_t) { measured = report; });
    bytes = mean_bytes(settings.store, plan, archives);
    seconds_each =
        scaled_seconds(measured, count_stages(settings.config, plan), runs, jobs) / static_cast<double>(runs);
    estimate.basis = fmt::format("from one run, measured now: {:.2f} s of which the stages that runs share count once",
                                 measured.seconds);
    if (measured.outcome == TrialOutcome::failed) estimate.basis = "unknown: the run measured for it failed";
  }
  estimate.left = runs - archives;
  estimate.seconds = seconds_each * static_cast<double>(estimate.left) / static_cast<double>(jobs);
  estimate.bytes = bytes * static_cast<double>(estimate.left);
  return estimate;
}

}  // namespace modebank::app
