#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "io/recording/definition.hpp"

namespace modebank {

/// definitions.txt.
extern const char* const known_definitions_text;

/// What a message of a type may be written as when the recording does not say.
class KnownDefinitions {
 public:
  /// `folder`: of .msg files, as FOLDER/package/msg/Type.msg, FOLDER/package/Type.msg or FOLDER/Type.msg; empty: none.
  explicit KnownDefinitions(std::filesystem::path folder = {}) : folder_(std::move(folder)) {}

  /// The library's own first (the newest before older ones), then the folder's. Those that cannot be used are left out;
  /// why is in `problem`.
  std::vector<std::shared_ptr<const Schema>> candidates(const std::string& type, std::string& problem) const;

 private:
  std::optional<std::string_view> from_folder(const std::string& type) const;

  std::filesystem::path folder_;
  mutable std::map<std::string, std::string> files_;  ///< of the folder, as far as they were read
};

}  // namespace modebank
