#include "app/report/site/index_row.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <vector>

#include "io/archive/inspect.hpp"

namespace modebank::app::report {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The text member of the object; empty if it does not exist.
std::string text_in(const json& object, const char* name) {
  return object.is_object() && object.contains(name) && object[name].is_string() ? object[name].get<std::string>() : "";
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

}  // namespace

void describe(const OpenArchive& archive, IndexRow& row) {
  row.data = data_name(files_of(archive));
  row.created = text_in(inspect(archive, "/").at("attributes"), "created");
  if (has(archive, "/", "evaluation") && has(archive, "/evaluation", "evidence"))
    row.text = text_in(inspect(archive, "/evaluation/evidence").at("attributes"), "text");
}

void describe(const FoundStudy& study, IndexRow& row) {
  std::vector<fs::path> files;
  for (const InputFile& file : study.content.provenance.inputs) files.emplace_back(file.path);
  row.data = data_name(files);
  row.created = study.content.provenance.created;
  row.text = fmt::format("{} of {} runs are done.", study.done, study.runs);
}

}  // namespace modebank::app::report
