#include "app/cli/log/log_outputs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>

#include "app/cli/log/log_sets.hpp"
#include "app/config/config_file.hpp"
#include "app/report/page/write_page.hpp"
#include "ident/base/printable.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

namespace fs = std::filesystem;

LogOutputs named(const fs::path& archive) {
  LogOutputs outputs{archive, archive, archive};
  outputs.configuration.replace_extension(".ini");
  outputs.page.replace_extension(".html");
  return outputs;
}

}  // namespace

LogOutputs log_outputs(const CommandLine& line, const std::vector<FileSet>& sets) {
  std::string stated;
  for (const auto& [key, value] : line.overrides)
    if (key == "archive.output") stated = value;
  if (!stated.empty()) {
    if (fs::path(stated).extension() != ".h5")
      throw ConfigurationError(
          fmt::format("--archive.output {}: a name that ends in .h5 is expected, which also names "
                      "the .ini and the .html",
                      stated));
    return named(stated);
  }
  const std::string name = name_after(sets);
  const std::vector<fs::path> logs = files_of(sets);
  const fs::path archive = fs::absolute(name + ".h5").lexically_normal();
  return named(std::find(logs.begin(), logs.end(), archive) == logs.end() ? name + ".h5" : name + "_run.h5");
}

void check_log_outputs(const CommandLine& line, const LogOutputs& outputs, const std::vector<FileSet>& sets) {
  std::vector<std::string> there;
  for (const fs::path& file : outputs.all())
    if (fs::exists(fs::symlink_status(file))) there.push_back(printable_name(file.string()));
  if (!there.empty() && !line.force)
    throw ConfigurationError(
        fmt::format("{} exist{}: replace with --force, or name other files with --archive.output "
                    "OTHER.h5",
                    fmt::join(there, ", "), there.size() == 1 ? "s" : ""));
  const std::vector<fs::path> logs = files_of(sets);
  check_configuration_output("run LOG", outputs.configuration, logs, true);
  report::check_page_path(outputs.page, logs);
}

}  // namespace modebank::app
