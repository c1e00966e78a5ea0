#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "app/chain/stage_store.hpp"

namespace modebank::app {

/// Stores stages that took long in a folder beside the future archive. A run that was stopped, by Ctrl-C or a power
/// cut, continues from there when it is repeated. Stores nothing in a folder that is a symbolic link.
class KeptStages : public StageSource {
 public:
  /// Installs a handler: Ctrl-C prints where the stages are stored.
  explicit KeptStages(const std::filesystem::path& output);
  /// Removes the folder after a run that ended, well or by an error, and restores the signal handlers.
  ~KeptStages() override;
  KeptStages(const KeptStages&) = delete;
  KeptStages& operator=(const KeptStages&) = delete;

  void provide(Stage stage, const std::string& key, const StagePart& part) override;

 private:
  bool folder_is_link() const;

  std::filesystem::path folder_;
  StageStore store_;
  std::array<void (*)(int), 2> before_{};  ///< previous handlers of SIGINT and SIGTERM
};

}  // namespace modebank::app
