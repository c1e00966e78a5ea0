#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "app/cli/commands.hpp"
#include "app/config/configuration_output.hpp"
#include "app/report/page/assets.hpp"
#include "io/files/read_file.hpp"
#include "io/files/replace_file.hpp"
#include "io/simulation/simulation_files.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

namespace fs = std::filesystem;

/// What the demo leaves in its folder. The configurations are the program's own, so that it needs no file beside
/// itself.
struct DemoFolder {
  fs::path folder;

  fs::path simulation() const { return folder / "simulate_ice.ini"; }
  fs::path configuration() const { return folder / "demo.ini"; }
  fs::path data() const { return folder / "data"; }
  fs::path archive() const { return folder / "demo.h5"; }
};

bool holds(const fs::path& file, std::string_view content) {
  return fs::is_regular_file(file) && read_file(file) == content;
}

bool holds_runs_alone(const fs::path& folder) {
  return fs::is_directory(folder) &&
         std::all_of(fs::directory_iterator(folder), fs::directory_iterator(), [](const fs::directory_entry& entry) {
           return entry.is_regular_file() && is_run_file(entry.path().filename().string());
         });
}

bool is_of_a_demo(const fs::path& path, const DemoFolder& demo) {
  if (path == demo.simulation()) return holds(path, assets::simulate_ice_ini());
  if (path == demo.configuration()) return holds(path, assets::demo_ini());
  if (path == demo.data()) return holds_runs_alone(path);
  return path == demo.archive() && fs::is_regular_file(path);
}

/// A demo may be repeated in the folder of an earlier one, which began by writing its configuration; anything else
/// there is somebody's.
void refuse_foreign_files(const DemoFolder& demo) {
  if (!fs::exists(demo.folder)) return;
  if (!fs::is_directory(demo.folder))
    throw ConfigurationError(fmt::format("-o {}: this is no folder", demo.folder.string()));
  for (const fs::directory_entry& entry : fs::directory_iterator(demo.folder))
    if (!fs::exists(demo.simulation()) || !is_of_a_demo(entry.path(), demo))
      throw ConfigurationError(fmt::format(
          "{} is not of a demo, or was changed since: name another folder (-o FOLDER), or --force to write "
          "{}, {}, {} and {} in this one",
          entry.path().string(), demo.simulation().filename().string(), demo.configuration().filename().string(),
          demo.data().filename().string(), demo.archive().filename().string()));
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directory(folder, error);  // no error when it exists
  if (error) throw ConfigurationError(fmt::format("cannot make folder {}: {}", folder.string(), error.message()));
}

/// Options that the demo was given go to the command that they are about; of where files lie it decides itself.
std::vector<std::string> options_for(const std::string& command, const CommandLine& line) {
  std::vector<std::string> options;
  for (const auto& [key, value] : line.overrides) {
    const std::string section = key.substr(0, key.find('.'));
    const bool simulates = section == "simulate";
    if (key == "data.root" || key == "archive.output" || key == "simulate.output")
      throw ConfigurationError(fmt::format("{}: demo has its files in one folder, -o FOLDER", key));
    if (section == "job" || simulates == (command == "simulate")) options.push_back(fmt::format("--{}={}", key, value));
  }
  return options;
}

/// The command as a user would type it, to be learned and repeated.
CommandLine typed_command(const CommandLine& demo, const std::vector<std::string>& words) {
  std::vector<std::string> all{demo.program};
  all.insert(all.end(), words.begin(), words.end());
  const std::vector<std::string> options = options_for(words.front(), demo);
  all.insert(all.end(), options.begin(), options.end());
  std::vector<const char*> argv;
  for (const std::string& word : all) argv.push_back(word.c_str());
  CommandLine command = parse_command_line(static_cast<int>(argv.size()), argv.data());
  command.json = demo.json;
  command.quiet = demo.quiet;
  return command;
}

}  // namespace

int run_demo(const CommandLine& line) {
  const DemoFolder demo{line.output.empty() ? "modebank_demo" : line.output};
  const CommandLine simulate = typed_command(
      line, {"simulate", demo.simulation().string(), fmt::format("--simulate.output={}", demo.data().string())});
  CommandLine run =
      typed_command(line, {"run", demo.configuration().string(), fmt::format("--data.root={}", demo.data().string()),
                           fmt::format("--archive.output={}", demo.archive().string())});
  run.force = true;  // the archive in its folder is the demo's own
  if (!line.force) refuse_foreign_files(demo);
  make_folder(demo.folder);
  for (const fs::path& file : {demo.simulation(), demo.configuration()})
    check_configuration_output("-o", file, {}, true);
  replace_file(demo.simulation(), {assets::simulate_ice_ini()});
  replace_file(demo.configuration(), {assets::demo_ini()});
  print_text(line, simulate.typed + "\n");
  print_text(line, do_simulate(simulate).text);
  print_text(line, run.typed + "\n");
  Result result = do_pipeline(run);
  result.text += fmt::format("Look inside: {0} show {1}\nA page of it: {0} report {1} -o demo.html\n", line.program,
                             shell_quoted(demo.archive().string()));
  return print_result(line, result);
}

}  // namespace modebank::app
