#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>

#include "app/cli/commands.hpp"
#include "app/cli/live_filter.hpp"
#include "app/cli/result.hpp"
#include "app/config/config_file.hpp"
#include "app/export/forms.hpp"
#include "app/export/names.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/files/output_file.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

using nlohmann::json;
using std::filesystem::path;

void check_export(const CommandLine& line, const path& output, const FileForm& form) {
  check_output({"-o", output, form}, {line.files.front()});
}

/// An exported file in C, Python or YAML begins with the verdict on the bank.
FileForm bank_form() { return form_by_front("an export of a bank", " Calibration: ", 16); }

/// Time by which the bank uses its inputs earlier than recorded.
double input_lag_of(const Archive& archive, const Config& config) {
  if (!config.data.lag_auto) return config.data.lag_s;
  return archive.lag && archive.lag->correction != LagCorrection::none ? archive.lag->lag.mean : 0.0;
}

/// Reads the filter with the options of the archive, because the scores belong to these options.
ExportedBank read_bank(const CommandLine& line) {
  const OpenArchive file(line.files.front());
  const Config config = stored_config(load_configuration(file), line.overrides);
  require_bank(config, fmt::format("track.filter = {}", name_of(config.track.filter)));
  const Archive archive = read_archive(file, Evaluations::in_file);
  ExportedBank bank =
      exported_bank(archive, file, tracked_bank(config), tracked_options(config), input_lag_of(archive, config));
  if (!bank.may_be_trusted() && !line.force)
    throw DataError(
        fmt::format("{}: the verdict on {} is {}. A program that relies on its uncertainty would be misled; --force "
                    "exports it in spite of that, with the verdict at the top",
                    file.path().string(), bank.filter, bank.verdict_text()));
  return bank;
}

/// The path given by -o; without -o the archive's name with another extension, in the current folder.
path output_of(const CommandLine& line, const std::string& ending) {
  if (!line.output.empty()) return line.output;
  return file_stem(path(line.files.front()).stem().string()) + ending;
}

/// Writes an export that is a single text. Without -o it is written to standard output. Returns the members for --json.
template <class Make>
json write_text(const CommandLine& line, const FileForm& form, Make make) {
  if (!line.output.empty()) check_export(line, line.output, form);
  const std::string text = make();
  if (line.output.empty()) {
    print_text(line, text);
    return {{"text", text}};
  }
  replace_file(final_target(line.output), {text});
  return {{"written", {line.output}}};
}

json export_json(const CommandLine& line) {
  return write_text(line, form_by_front("an export of a bank", "\"modebank export\"", 64),
                    [&] { return to_json(read_bank(line)); });
}

json export_regimes(const CommandLine& line) {
  return write_text(line, form_by_front("an export of regimes", "\"modebank regimes\"", 64),
                    [&] { return to_regimes(read_bank(line)); });
}

json export_casadi(const CommandLine& line) {
  return write_text(line, bank_form(), [&] { return to_casadi(read_bank(line)); });
}

/// All arrays of a group as a table with one row per sample of a run.
json samples_of(const OpenArchive& archive, const std::string& group, const std::string& run, const json& members) {
  json table = {{"columns", json::array()}, {"value", json::array()}};
  const auto add = [&](const std::string& name) {
    const json values = inspect(archive, group + "/" + name, run).at("value");
    table["columns"].push_back(name);
    for (std::size_t k = 0; k < values.size(); ++k) table["value"][k][name] = values[k];
  };
  if (members.contains("time")) add("time");
  for (const auto& [name, member] : members.items())
    if (name != "time") add(name);
  return table;
}

/// The object that the command line selects. For a run without a path, the object contains all data of this run.
json asked_table(const CommandLine& line, const std::string& path) {
  const OpenArchive archive(line.files.front());
  json object = inspect(archive, path, line.run);
  const bool is_group = !line.run.empty() && object.contains("members");
  return is_group ? samples_of(archive, path, line.run, object.at("members")) : object;
}

json export_csv(const CommandLine& line) {
  const std::string table = line.table.empty() && !line.run.empty() ? "/data" : line.table;
  if (table.empty())
    throw ConfigurationError(
        "export --to csv needs --table PATH, such as /evaluation/summary (modebank show ARCHIVE /), or --run NAME");
  const std::string text = to_csv(asked_table(line, table), table);
  const std::string header = text.substr(0, text.find('\n') + 1);
  return write_text(line, form_by_front("a table with these columns", header, header.size()), [&] { return text; });
}

json export_mat(const CommandLine& line) {
  const path output = output_of(line, ".mat");
  check_export(line, output, form_by_front("an export of a bank", "by modebank export", 64));
  const ExportedBank bank = read_bank(line);
  write_mat(bank, output);
  print_text(line,
             fmt::format("wrote {0}: in MATLAB or Octave, m = load('{0}'); A = m.A(:, :, 1) is mode 1 of {1} ...\n"
                         "  x[k+1] = A x[k] + B u[k] + c every m.dt_s; m.ss_lines has the code for a system\n",
                         output.string(), bank.bank.modes.size()));
  return {{"written", {output.string()}}};
}

/// Both texts are made before the first file is written.
json export_c(const CommandLine& line) {
  path source = output_of(line, ".c");
  if (std::filesystem::is_directory(source)) source /= file_stem(path(line.files.front()).stem().string()) + ".c";
  if (source.extension() != ".c")
    throw ConfigurationError(fmt::format(
        "-o {}: give a name that ends in .c (the header is written beside it), or a folder", source.string()));
  const std::string stem = source.stem().string();
  if (stem != file_stem(stem))
    throw ConfigurationError(fmt::format("-o {}: use only letters, digits, '_' and '-'", source.string()));
  const path header = path(source).replace_extension(".h");
  for (const path& file : {source, header}) check_export(line, file, bank_form());
  const CFiles files = to_c(read_bank(line), stem);
  replace_file(final_target(header), {files.header});
  replace_file(final_target(source), {files.source});
  print_text(
      line,
      fmt::format("wrote {0} and {1}: #include \"{2}\", {3}_restart begins a {3}_filter, {3}_step takes each sample\n"
                  "  cc -std=c99 -O2 -c {0}; link with -lm\n",
                  source.string(), header.string(), header.filename().string(), file_stem(stem)));
  return {{"written", {source.string(), header.string()}}};
}

json export_ros2(const CommandLine& line) {
  const RobotSizes sizes{line.wheel_separation_m, line.wheel_radius_m};
  if (!(sizes.wheel_separation_m >= 0.0 && sizes.wheel_radius_m >= 0.0))
    throw ConfigurationError("--wheel_separation_m and --wheel_radius_m are lengths above 0");
  const auto files = to_ros2(read_bank(line), sizes);
  const path folder = output_of(line, "_ros2");
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (is_disk_failure(error)) throw DataError(fmt::format("cannot write {}: {}", folder.string(), error.message()));
  if (error) throw ConfigurationError(fmt::format("-o {}: {}", folder.string(), error.message()));
  for (const auto& [name, text] : files) check_export(line, folder / name, bank_form());
  std::string names;
  json written = json::array();
  for (const auto& [name, text] : files) {
    replace_file(folder / name, {text});
    written.push_back((folder / name).string());
    names += (names.empty() ? "" : ", ") + name;
  }
  print_text(line, fmt::format("wrote {0}: {1}\n  copy the keys of your ground into your own parameter files; comments "
                               "name the channel or option that a missing key needs\n",
                               folder.string(), names));
  return {{"written", written}};
}

const std::map<std::string, json (*)(const CommandLine&)> forms{
    {"c", export_c},     {"casadi", export_casadi},   {"csv", export_csv},  {"json", export_json},
    {"mat", export_mat}, {"regimes", export_regimes}, {"ros2", export_ros2}};

/// Throws for options that apply only to another form.
void check_form_options(const CommandLine& line) {
  const std::map<std::string, std::string> belongs{
      {"table", "csv"}, {"run", "csv"}, {"wheel_separation_m", "ros2"}, {"wheel_radius_m", "ros2"}};
  for (const std::string& option : line.given)
    if (const auto only = belongs.find(option); only != belongs.end() && only->second != line.to)
      throw ConfigurationError(
          fmt::format("--{} belongs to export --to {}, not to --to {}", option, only->second, line.to));
}

}  // namespace

int run_export(const CommandLine& line) {
  const auto form = forms.find(line.to);
  if (form == forms.end())
    throw ConfigurationError(fmt::format(
        "export needs one of the forms json, regimes, mat, c, casadi, ros2 and csv: modebank export {} --to "
        "json",
        line.files.front()));
  check_form_options(line);
  json result = form->second(line);
  result["form"] = line.to;
  print_json(line, result);
  return 0;
}

}  // namespace modebank::app
