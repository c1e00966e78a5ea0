#include "app/report/site/index_row.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

#include "io/archive/inspect.hpp"

namespace modebank::app::report {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The member of the object; null if it does not exist.
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

/// The name of the data file. For several files, the folder of the first file and their number.
std::string data_name(const std::vector<fs::path>& files) {
  if (files.empty()) return {};
  if (files.size() == 1) return files.front().filename().string();
  return fmt::format("{}, {} files", files.front().parent_path().filename().string(), files.size());
}

std::vector<fs::path> files_of(const OpenArchive& archive) {
  std::vector<fs::path> files;
  if (has(archive, "/provenance", "inputs"))
    for (const json& row : inspect(archive, "/provenance/inputs").at("value")) files.emplace_back(text_in(row, "path"));
  return files;
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
  json line = {
      {"kind", "run"}, {"created", text_in(root.at("attributes"), "created")}, {"data", data_name(files_of(archive))}};
  if (root.at("members").contains("evaluation")) {
    add_verdict(archive, line);
    add_scores(archive, line);
  }
  return line;
}

json index_row(const FoundStudy& study) {
  const Provenance& provenance = study.content.provenance;
  std::vector<fs::path> files;
  for (const InputFile& file : provenance.inputs) files.emplace_back(file.path);
  return {{"kind", "study"},
          {"created", provenance.created},
          {"data", data_name(files)},
          {"text", fmt::format("{} of {} runs are done.", study.done, study.runs)}};
}

}  // namespace modebank::app::report
