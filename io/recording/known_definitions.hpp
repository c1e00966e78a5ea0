#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "io/recording/definition.hpp"

namespace modebank {

/// Content of definitions.txt.
extern const char* const known_definitions_text;

/// Possible definitions of message types whose recording has none.
class KnownDefinitions {
 public:
  /// `folder`: has .msg files as FOLDER/package/msg/Type.msg, FOLDER/package/Type.msg or FOLDER/Type.msg; empty: none.
  explicit KnownDefinitions(std::filesystem::path folder = {}) : folder_(std::move(folder)) {}

  /// The library's definitions (newer ones first), then the folder's. Unusable ones are left out; `problem` gets the
  /// reason.
  std::vector<std::shared_ptr<const Schema>> candidates(const std::string& type, std::string& problem) const;

 private:
  std::optional<std::string_view> from_folder(const std::string& type) const;

  std::filesystem::path folder_;
  mutable std::map<std::string, std::string> files_;  ///< texts of the folder's files that were read
};

}  // namespace modebank
