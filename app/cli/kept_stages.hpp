#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "app/chain/stage_store.hpp"

namespace modebank::app {

/// Stores slow stages in a folder beside the future archive. After a stop (Ctrl-C, power cut) the same command
/// continues from these stages. If the folder is a symbolic link, nothing is stored.
class KeptStages : public StageSource {
 public:
  /// Installs a signal handler. On Ctrl-C, it prints the path of the folder with the stored stages.
  explicit KeptStages(const std::filesystem::path& output);
  /// Restores the signal handlers. Removes the folder, unless an error ended the run: then the stages stay.
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
