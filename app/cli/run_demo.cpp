#include <fmt/format.h>

#include <algorithm>

#include "app/cli/commands.hpp"
#include "app/cli/demo_text.hpp"
#include "app/cli/log.hpp"
#include "app/config/config_file.hpp"
#include "app/report/page/assets.hpp"
#include "io/archive/archive.hpp"
#include "io/files/read_file.hpp"
#include "io/files/replace_file.hpp"
#include "io/simulation/simulation_files.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

namespace fs = std::filesystem;

/// The files of the demo, all in one folder. Their configurations are built into the program.
struct DemoFolder {
  fs::path folder;

  fs::path simulation() const { return folder / "simulate_demo.ini"; }
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

bool is_of_the_demo(const fs::path& path, const DemoFolder& demo) {
  if (path == demo.simulation()) return holds(path, assets::simulate_demo_ini());
  if (path == demo.configuration()) return holds(path, assets::demo_ini());
  if (path == demo.data()) return holds_runs_alone(path);
  return path == demo.archive() && fs::is_regular_file(path);
}

/// The demo may run again in the folder of an earlier demo, which contains its configurations. It does not replace
/// other files.
void refuse_foreign_files(const DemoFolder& demo) {
  if (!fs::exists(demo.folder)) return;
  if (!fs::is_directory(demo.folder))
    throw ConfigurationError(fmt::format("-o {}: not a folder", demo.folder.string()));
  for (const fs::directory_entry& entry : fs::directory_iterator(demo.folder))
    if (!fs::exists(demo.simulation()) || !is_of_the_demo(entry.path(), demo))
      throw ConfigurationError(fmt::format(
          "{} is not a file of the demo, or was changed since: name another folder (-o FOLDER), or --force to write "
          "{}, {}, {} and {} in this one",
          entry.path().string(), demo.simulation().filename().string(), demo.configuration().filename().string(),
          demo.data().filename().string(), demo.archive().filename().string()));
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directory(folder, error);  // an existing folder gives no error
  if (error) throw ConfigurationError(fmt::format("cannot make folder {}: {}", folder.string(), error.message()));
}

/// Passes each option of the demo to the command that reads it. The folder of the files is not an option: the demo sets
/// it.
std::vector<std::string> options_for(const std::string& command, const CommandLine& line) {
  std::vector<std::string> options;
  for (const auto& [key, value] : line.overrides) {
    const std::string section = key.substr(0, key.find('.'));
    const bool simulates = section == "simulate";
    if (key == "data.root" || key == "archive.output" || key == "simulate.output")
      throw ConfigurationError(fmt::format("{}: the files of demo are in one folder; set it by -o FOLDER", key));
    if (section == "job" || simulates == (command == "simulate")) options.push_back(fmt::format("--{}={}", key, value));
  }
  return options;
}

/// The command as a user would type it. It is printed so that users can learn and repeat it.
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

void write_configurations(const CommandLine& line, const DemoFolder& demo) {
  if (!line.force) refuse_foreign_files(demo);
  make_folder(demo.folder);
  for (const fs::path& file : {demo.simulation(), demo.configuration()})
    check_configuration_output("-o", file, {}, true);
  replace_file(demo.simulation(), {assets::simulate_demo_ini()});
  replace_file(demo.configuration(), {assets::demo_ini()});
}

/// If the archive and the true system can be compared, prints this comparison in place of the first screen.
void add_truth(const DemoFolder& demo, const CommandLine& simulate, Result& result) {
  Config simulation = load_config(demo.simulation(), simulate.overrides);
  read_system(demo.folder, simulation);
  const Archive archive = read_archive(OpenArchive(demo.archive()));
  if (!is_comparable(archive, simulation)) return;
  const DemoFindings findings = compare_with_truth(archive, simulation);
  result.text = demo_text(archive, findings, resolved_values(archive.config));
  result.members["truth"] = demo_json(findings);
}

std::string closing_words(const DemoFolder& demo, const std::string& program) {
  return fmt::format("All results: {0} show {1}\nAs a page: {0} report {1} -o demo.html\n", program,
                     shell_quoted(demo.archive().string()));
}

constexpr std::string_view introduction =
    "A simulated robot turns quickly on grip and slowly on ice. Its log has the set speeds of its wheels\n"
    "(cmd_velL, cmd_velR) and its turn rate (wz). Its motion on each ground must be found from these.\n";

}  // namespace

int run_demo(const CommandLine& line) {
  const DemoFolder demo{line.output.empty() ? "modebank_demo" : line.output};
  const CommandLine simulate = typed_command(
      line, {"simulate", demo.simulation().string(), fmt::format("--simulate.output={}", demo.data().string())});
  CommandLine run = typed_command(
      line, {"run", demo.configuration().string(), fmt::format("--archive.output={}", demo.archive().string())});
  run.force = true;  // --force is safe: the archive in the demo's folder was made by a demo
  run.quiet = run.quiet || !line.verbose;
  write_configurations(line, demo);
  if (run.quiet && !line.quiet) set_up_log(Verbosity::warnings);
  print_text(line, introduction);
  print_text(line, simulate.typed + "\n");
  print_text(line, do_simulate(simulate).text);
  print_text(line, run.typed + "\n");
  Result result = do_pipeline(run);
  add_truth(demo, simulate, result);
  result.text += closing_words(demo, line.program);
  return print_result(line, result);
}

}  // namespace modebank::app
