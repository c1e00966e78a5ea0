#include "app/cli/dry_run.hpp"

#include <fmt/format.h>

#include "io/import/import.hpp"

namespace modebank::app {

int print_dry_run(const Config& config, const std::vector<std::filesystem::path>& written) {
  std::vector<std::filesystem::path> read;
  // An archive that supplies earlier stages supplies the data, too.
  if (config.archive.input.empty() && !config.data.inputs.empty())
    for (const DataFile& file : data_files(config.data)) read.push_back(file.path);
  for (const std::string& archive : {config.archive.input, config.archive.bank, config.mixture_start})
    if (!archive.empty()) read.emplace_back(archive);
  for (const std::filesystem::path& file : read) fmt::print("reads     {}\n", file.string());
  for (const std::filesystem::path& file : written)
    fmt::print("writes    {}{}\n", file.string(), std::filesystem::exists(file) ? " (is there)" : "");
  return 0;
}

}  // namespace modebank::app
