#include "app/report/site/index_row.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "io/archive/inspect.hpp"

namespace modebank::app::report {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Null where there is no such member.
json member(const json& object, const char* name) {
  return object.is_object() && object.contains(name) ? object[name] : json();
}

std::string text_in(const json& object, const char* name) {
  const json found = member(object, name);
  return found.is_string() ? found.get<std::string>() : std::string();
}

bool has(const OpenArchive& archive, const std::string& group, const char* name) {
  return inspect(archive, group).at("members").contains(name);
}

/// The name of the file that was read, or of the folder of the first and how many there are.
std::string data_name(const OpenArchive& archive) {
  if (!has(archive, "/provenance", "inputs")) return {};
  const json rows = inspect(archive, "/provenance/inputs").at("value");
  if (!rows.is_array() || rows.empty()) return {};
  const fs::path first = text_in(rows[0], "path");
  if (rows.size() == 1) return first.filename().string();
  return fmt::format("{}, {} files", first.parent_path().filename().string(), rows.size());
}

void add_verdict(const OpenArchive& archive, json& line) {
  if (!has(archive, "/evaluation", "evidence")) return;
  const json found = inspect(archive, "/evaluation/evidence").at("attributes");
  for (const char* name : {"answer", "text", "modes", "gain", "standard_error"}) line[name] = member(found, name);
}

void add_scores(const OpenArchive& archive, json& line) {
  if (!has(archive, "/evaluation", "summary")) return;
  const json rows = inspect(archive, "/evaluation/summary").at("value");
  for (const json& row : rows)
    if (text_in(row, "filter") == "bank" && text_in(row, "role") == "test" && text_in(row, "run") == "*")
      for (const char* name : {"samples", "log_score", "coverage_95"}) line[name] = member(row, name);
}

}  // namespace

json index_row(const OpenArchive& archive) {
  const json root = inspect(archive, "/");
  json line = {{"created", text_in(root.at("attributes"), "created")}, {"data", data_name(archive)}};
  const bool is_study = root.at("members").contains("study");
  line["kind"] = is_study ? "study" : "run";
  if (!is_study && root.at("members").contains("evaluation")) {
    add_verdict(archive, line);
    add_scores(archive, line);
  }
  return line;
}

}  // namespace modebank::app::report
