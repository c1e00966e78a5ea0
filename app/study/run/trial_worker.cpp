#include "app/study/run/trial_worker.hpp"

#include <fmt/format.h>

#include <chrono>
#include <limits>

#include "io/archive/study_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

double headline_score(const std::vector<std::pair<std::string, double>>& scores) {
  double score = std::numeric_limits<double>::quiet_NaN();
  for (const char* name : {"bank_train_log_score", "bank_test_log_score"})  // the latter where there is one
    for (const auto& [key, value] : scores)
      if (key == name) score = value;
  return score;
}

}  // namespace

TrialWorker::TrialWorker(const WorkerSettings& settings, std::function<void(bool)> tell_waiting)
    : settings_(settings),
      locks_(settings.store.lock_file()),
      cache_(settings.store.cache(), settings.config.study.cache_mb, locks_, std::move(tell_waiting)),
      runner_(&cache_) {}

std::optional<TrialReport> TrialWorker::settled(const TrialRow& row, std::string& found) {
  const TrialStore& store = settings_.store;
  TrialReport report;
  if (store.has_archive(row.key)) {
    const std::vector<std::string> problems = store.problems(row.key);
    if (problems.empty()) {
      report.outcome = TrialOutcome::present;
      report.log_score = headline_score(read_trial_scores(store.archive(row.key)).pooled);
      return report;
    }
    found = fmt::format("{}: {}; computed again", store.archive(row.key).string(), problems.front());
  }
  const std::optional<FailureRecord> failure = store.failure(row.key);
  const auto earlier = settings_.earlier_failures.find(row.key);
  const bool is_earlier = earlier != settings_.earlier_failures.end() && failure == earlier->second;
  if (!failure || (settings_.config.study.retry && is_earlier)) return std::nullopt;
  report.outcome = TrialOutcome::failed;
  report.message = failure->message;
  return report;
}

TrialReport TrialWorker::take(const TrialRow& row) {
  const FileLocks::Hold mine = locks_.try_lock(row.key);
  if (!mine) {
    held_.insert(row.key);
    return {};
  }
  if (held_.erase(row.key) > 0) settings_.store.look_again();  // it is done now, though just now it was not
  std::string found;
  if (const auto before = settled(row, found)) return *before;
  const auto start = std::chrono::steady_clock::now();
  TrialReport report = compute(row);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  report.stage_seconds = runner_.seconds();
  if (report.message.empty()) report.message = found;
  return report;
}

TrialReport TrialWorker::compute(const TrialRow& row) {
  TrialReport report;
  const Config config = trial_config(settings_.config, settings_.varied_keys, row);
  const Archive* archive = nullptr;
  try {
    archive = &runner_.run(config, settings_.typed);
  } catch (const std::exception& error) {
    report.outcome = TrialOutcome::failed;
    report.message = error.what();
  }
  try {
    if (archive)
      write(row, config, *archive, report);
    else
      settings_.store.record_failure(row.key, {report.message, settings_.execution});
  } catch (const std::exception& error) {
    report.outcome = TrialOutcome::broken;
    report.message = error.what();
  }
  return report;
}

void TrialWorker::write(const TrialRow& row, const Config& config, const Archive& archive, TrialReport& report) {
  if (trial_key(config, archive.provenance.data_hash, settings_.version) != row.key)
    throw DataError("the data changed since they were planned; start again to see which file");
  // Where locks are not seen another process may have been first: what others may be reading stays.
  const TrialStore& store = settings_.store;
  if (!store.has_archive(row.key) || !store.problems(row.key).empty()) write_archive(store.archive(row.key), archive);
  store.forget_failure(row.key);
  report.outcome = TrialOutcome::computed;
  report.log_score = headline_score(pooled_scores(archive.summary, names_of(archive.recording->states)));
}

}  // namespace modebank::app
