#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "app/chain/stage_store.hpp"

namespace modebank::app {

/// Keeps stages that took long in a folder beside the archive that is to come, so that a run that was stopped, by
/// Ctrl-C or a power cut, goes on from there when it is repeated. Keeps nothing in a folder that is a symbolic link.
class KeptStages : public StageSource {
 public:
  /// From now on Ctrl-C prints what is kept.
  explicit KeptStages(const std::filesystem::path& output);
  /// Nothing is left of a run that ended, well or by an error; signals do what they did before.
  ~KeptStages() override;
  KeptStages(const KeptStages&) = delete;
  KeptStages& operator=(const KeptStages&) = delete;

  void provide(Stage stage, const std::string& key, const StagePart& part) override;

 private:
  bool folder_is_link() const;

  std::filesystem::path folder_;
  StageStore store_;
  std::array<void (*)(int), 2> before_{};  ///< what SIGINT and SIGTERM did
};

}  // namespace modebank::app
