#include "app/view/jobs.hpp"

#include <algorithm>
#include <exception>

namespace modebank::app::view {

namespace fs = std::filesystem;

Jobs::~Jobs() {
  while (!jobs_.empty()) cancel(jobs_.front().number);
}

std::uint64_t Jobs::add(std::vector<std::string> arguments, std::vector<NamedFile> files, Done done) {
  const std::uint64_t number = ++last_;
  jobs_.push_back({number, std::move(arguments), std::move(files), std::move(done)});
  tend();
  return number;
}

void Jobs::cancel(std::uint64_t number) {
  const auto job = std::find_if(jobs_.begin(), jobs_.end(), [&](const Job& each) { return each.number == number; });
  if (job == jobs_.end()) return;
  const fs::path folder = folder_of(*job);
  if (job->child) --running_;
  jobs_.erase(job);
  std::error_code none;
  fs::remove_all(folder, none);
}

void Jobs::start(Job& job) {
  fs::create_directories(folder_of(job));
  job.child = std::make_unique<Child>(folder_of(job), job.arguments, job.files);
  ++running_;
  job.files.clear();
}

void Jobs::finish(std::list<Job>::iterator job, const std::string& failure) {
  std::list<Job> taken;  // whoever is called may add and cancel
  taken.splice(taken.begin(), jobs_, job);
  if (taken.front().child) --running_;
  const fs::path folder = folder_of(taken.front());
  taken.front().done(failure, folder);
  std::error_code none;
  fs::remove_all(folder, none);
}

void Jobs::tend() {
  const auto ended = [](Job& job) { return job.child && job.child->ended(); };
  for (auto job = std::find_if(jobs_.begin(), jobs_.end(), ended); job != jobs_.end();
       job = std::find_if(jobs_.begin(), jobs_.end(), ended))
    finish(job, job->child->failure());
  const auto waits = [](const Job& job) { return !job.child; };
  for (auto job = std::find_if(jobs_.begin(), jobs_.end(), waits); running_ < at_once_ && job != jobs_.end();
       job = std::find_if(jobs_.begin(), jobs_.end(), waits)) {
    try {
      start(*job);
    } catch (const std::exception& error) {  // a full disk, no process left
      finish(job, error.what());
    }
  }
}

}  // namespace modebank::app::view
