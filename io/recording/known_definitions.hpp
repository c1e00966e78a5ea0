#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "io/recording/definition.hpp"

namespace modebank {

/// Content of the file definitions.txt.
extern const char* const known_definitions_text;

/// Possible definitions of message types that the recording does not define.
class KnownDefinitions {
 public:
  /// `folder`: contains .msg files as FOLDER/package/msg/Type.msg, FOLDER/package/Type.msg or FOLDER/Type.msg. Empty:
  /// no folder.
  explicit KnownDefinitions(std::filesystem::path folder = {}) : folder_(std::move(folder)) {}

  /// The library's definitions (newer ones first), then the definitions in the folder. Unusable definitions are
  /// skipped; `problem` receives the reason.
  std::vector<std::shared_ptr<const Schema>> candidates(const std::string& type, std::string& problem) const;

 private:
  std::optional<std::string_view> from_folder(const std::string& type) const;

  std::filesystem::path folder_;
  mutable std::map<std::string, std::string> files_;  ///< texts of all files in the folder that were read
};

}  // namespace modebank
