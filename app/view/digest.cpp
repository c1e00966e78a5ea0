#include "app/view/digest.hpp"

#include <fmt/format.h>

#include "io/archive/archive.hpp"
#include "io/archive/inspect.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app::view {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t longest_text = 1000;

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

void add_verdict(const OpenArchive& archive, json& digest) {
  if (!has(archive, "/evaluation", "evidence")) return;
  const json found = inspect(archive, "/evaluation/evidence").at("attributes");
  for (const char* name : {"answer", "text", "modes", "gain", "standard_error"}) digest[name] = member(found, name);
}

void add_scores(const OpenArchive& archive, json& digest) {
  if (!has(archive, "/evaluation", "summary")) return;
  const json rows = inspect(archive, "/evaluation/summary").at("value");
  for (const json& row : rows)
    if (text_in(row, "filter") == "bank" && text_in(row, "role") == "test" && text_in(row, "run") == "*")
      for (const char* name : {"samples", "log_score", "coverage_95"}) digest[name] = member(row, name);
}

}  // namespace

json digest_of(const fs::path& file) {
  const OpenArchive archive(file);
  const json root = inspect(archive, "/");
  json digest = {{"created", text_in(root.at("attributes"), "created")}, {"data", data_name(archive)}};
  const bool is_study = root.at("members").contains("study");
  digest["kind"] = is_study ? "study" : "run";
  if (!is_study && root.at("members").contains("evaluation")) {
    add_verdict(archive, digest);
    add_scores(archive, digest);
  }
  return digest;
}

json checked_digest(const std::string& text) {
  const json given = json::parse(text, nullptr, false);
  if (!given.is_object()) throw DataError("it could not be read");
  json digest;
  for (const char* name : {"kind", "created", "data", "answer", "text"})
    if (const std::string value = text_in(given, name); !value.empty()) digest[name] = value.substr(0, longest_text);
  for (const char* name : {"modes", "gain", "standard_error", "samples", "log_score", "coverage_95"})
    if (const json value = member(given, name); value.is_number()) digest[name] = value;
  return digest;
}

}  // namespace modebank::app::view
