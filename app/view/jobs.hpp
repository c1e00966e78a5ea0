#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "app/view/child.hpp"

namespace modebank::app::view {

/// Children at work, a few at a time; the others wait in order. Nothing here blocks: tend() is called again and again.
class Jobs {
 public:
  /// `failure` is empty where `folder` holds the result, which is gone when this returns.
  using Done = std::function<void(const std::string& failure, const std::filesystem::path& folder)>;

  Jobs(std::filesystem::path folder, std::size_t at_once) : folder_(std::move(folder)), at_once_(at_once) {}
  ~Jobs();  ///< kills all and calls nobody

  std::uint64_t add(std::vector<std::string> arguments, std::vector<NamedFile> files, Done done);
  /// Its result is not wanted any more; nobody is called.
  void cancel(std::uint64_t job);
  /// Takes what has ended and starts what waits.
  void tend();
  bool idle() const { return jobs_.empty(); }

 private:
  struct Job {
    std::uint64_t number;
    std::vector<std::string> arguments;
    std::vector<NamedFile> files;
    Done done;
    std::unique_ptr<Child> child = {};  ///< none yet: it waits
  };

  std::filesystem::path folder_of(const Job& job) const { return folder_ / std::to_string(job.number); }
  void start(Job& job);
  void finish(std::list<Job>::iterator job, const std::string& failure);

  std::filesystem::path folder_;
  std::size_t at_once_, running_ = 0;
  std::list<Job> jobs_;
  std::uint64_t last_ = 0;
};

}  // namespace modebank::app::view
