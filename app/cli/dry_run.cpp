#include "app/cli/dry_run.hpp"

#include <fmt/format.h>

#include "io/import/import.hpp"

namespace modebank::app {

Result dry_run(const Config& config, const std::vector<std::filesystem::path>& written) {
  std::vector<std::filesystem::path> read;
  // If archive.input is set, the data come from that archive.
  if (config.archive.input.empty() && !config.data.inputs.empty())
    for (const DataFile& file : data_files(config.data)) read.push_back(file.path);
  for (const std::string& archive : {config.archive.input, config.archive.bank})
    if (!archive.empty()) read.emplace_back(archive);
  Result result;
  nlohmann::json reads = nlohmann::json::array(), writes = nlohmann::json::array();
  for (const std::filesystem::path& file : read) {
    result.text += fmt::format("reads     {}\n", file.string());
    reads.push_back(file.string());
  }
  for (const std::filesystem::path& file : written) {
    const bool exists = std::filesystem::exists(file);
    result.text += fmt::format("writes    {}{}\n", file.string(), exists ? " (is there)" : "");
    writes.push_back({{"file", file.string()}, {"exists", exists}});
  }
  result.members = {{"reads", reads}, {"writes", writes}};
  return result;
}

}  // namespace modebank::app
