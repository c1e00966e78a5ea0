#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "io/archive/inspect.hpp"

namespace modebank::test {

/// All numbers of an archive below `path`, as text from which the same numbers can be read back.
inline std::string numbers_of(const std::string& archive, const std::string& path) {
  const nlohmann::json object = inspect(archive, path);
  if (!object.contains("members")) return path + object.at("value").dump() + "\n";
  std::string text = path + object.at("attributes").dump() + "\n";
  for (const auto& [name, member] : object.at("members").items())
    text += numbers_of(archive, (path == "/" ? "" : path) + "/" + name);
  return text;
}

inline std::string all_stages(const std::string& archive) {
  std::string text;
  for (const char* stage : {"/data", "/windows", "/mixture", "/bank", "/baseline", "/noise_only", "/one_motion",
                            "/drifting", "/evaluation", "/evaluation/evidence", "/residual_tests"})
    text += numbers_of(archive, stage);
  return text;
}

}  // namespace modebank::test
