#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "app/chain/stage_file.hpp"
#include "app/study/run/file_locks.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app {

/// Stages that trials in different processes share, one archive of that stage alone per file (stage_file_name), in a
/// folder of bounded size: the files used longest ago go first. Other files there do not count and stay.
class StageCache {
 public:
  /// `tell_waiting` hears when this process begins (true) and ceases to wait for a stage that another one computes.
  StageCache(std::filesystem::path folder, double limit_mb, const FileLocks& locks,
             std::function<void(bool)> tell_waiting = {});

  /// The stage of this name and key: from a file, or by `compute`, which is called by one process at a
  /// time. It says whether its result is worth a file, and is then asked for it by `part`.
  void provide(Stage stage, const std::string& key, const std::function<void(Archive&&)>& take,
               const std::function<bool()>& compute, const std::function<Archive()>& part) const;

 private:
  FileLocks::Hold wait_for(const std::string& stem) const;
  bool load(const std::filesystem::path& file, const std::function<void(Archive&&)>& take) const;
  void store(const std::filesystem::path& file, const Archive& part) const;
  void make_room() const;

  std::filesystem::path folder_;
  double limit_bytes_;
  const FileLocks& locks_;
  std::function<void(bool)> tell_waiting_;
};

}  // namespace modebank::app
