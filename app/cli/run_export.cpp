#include <fmt/format.h>

#include "app/cli/commands.hpp"
#include "app/cli/live_filter.hpp"
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

/// Without -o the text is written to standard output. Returns the members for --json.
json export_json(const CommandLine& line) {
  if (!line.output.empty())
    check_export(line, line.output, form_by_front("an export of a bank", "\"modebank export\"", 64));
  const std::string text = to_json(read_bank(line));
  if (line.output.empty()) {
    print_text(line, text);
    return {{"text", text}};
  }
  replace_file(final_target(line.output), {text});
  return {{"written", {line.output}}};
}

/// Both texts are made before the first file is written.
json export_c(const CommandLine& line) {
  const std::string name = file_stem(path(line.files.front()).stem().string()) + ".c";
  path source = line.output.empty() ? name : line.output;
  if (std::filesystem::is_directory(source)) source /= name;
  if (source.extension() != ".c")
    throw ConfigurationError(fmt::format(
        "-o {}: give a name that ends in .c (the header is written beside it), or a folder", source.string()));
  const std::string stem = source.stem().string();
  if (stem != file_stem(stem))
    throw ConfigurationError(fmt::format("-o {}: use only letters, digits, '_' and '-'", source.string()));
  const path header = path(source).replace_extension(".h");
  for (const path& file : {source, header})
    check_export(line, file, form_by_front("an export of a bank", " Calibration: ", 16));
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

}  // namespace

int run_export(const CommandLine& line) {
  const auto form = line.to == "json" ? export_json : line.to == "c" ? export_c : nullptr;
  if (!form)
    throw ConfigurationError(
        fmt::format("export needs one of the forms json and c: modebank export {} --to json", line.files.front()));
  json result = form(line);
  result["form"] = line.to;
  print_json(line, result);
  return 0;
}

}  // namespace modebank::app
