#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <map>
#include <optional>

#include "app/commands.hpp"
#include "app/config_file.hpp"
#include "app/pipeline.hpp"
#include "app/provenance.hpp"
#include "app/summary_text.hpp"
#include "ident/error.hpp"
#include "io/archive.hpp"
#include "io/import.hpp"

namespace modebank::app {
namespace {

/// Stages that are taken as they are must have been made as the configuration says, which the new archive will record.
void check_same_settings(const Config& config, const std::string& stored, const std::vector<std::string>& sections) {
  const std::map<std::string, std::string> before = resolved_values(stored),
                                           now = resolved_values(resolved_text(config));
  for (const auto& [key, value] : now) {
    const std::string section = key.substr(0, key.find('.'));
    const bool decides = std::find(sections.begin(), sections.end(), section) != sections.end() && decides_numbers(key);
    if (const auto stage = before.find(key); decides && stage != before.end() && stage->second != value)
      throw ConfigurationError(
          fmt::format("archive.input: {} was made with {} = {}, the configuration says '{}': take the stored value, or "
                      "start from the data",
                      config.archive.input, key, stage->second.empty() ? "''" : stage->second, value));
  }
}

/// Earlier stages from --archive.input; what the file lacks is computed.
void take_earlier_stages(const Config& config, const std::string& command, Archive& archive) {
  Archive stored = read_archive(config.archive.input);
  if (!stored.recording) throw DataError(fmt::format("{}: holds no data", config.archive.input));
  std::vector<std::string> sections{"data"};
  if (command != "identify" && stored.windows) sections.emplace_back("window");
  if (command == "evaluate" && stored.mixture) sections.insert(sections.end(), {"mixture", "job"});
  check_same_settings(config, stored.config, sections);
  archive.recording = std::move(stored.recording);
  archive.lag = std::move(stored.lag);
  archive.provenance.inputs = std::move(stored.provenance.inputs);
  archive.provenance.inputs.push_back(describe_file(config.archive.input));
  archive.provenance.data_hash = std::move(stored.provenance.data_hash);
  if (command != "identify") archive.windows = std::move(stored.windows);
  if (command == "evaluate") archive.mixture = std::move(stored.mixture);
}

void check_usage(const CommandLine& line, const Config& config) {
  if (line.command == "run" && !config.archive.input.empty())
    throw ConfigurationError(
        "archive.input: run starts from the data; identify, cluster and evaluate take earlier stages");
  if (line.command != "evaluate" && !config.archive.bank.empty())
    throw ConfigurationError("archive.bank: only evaluate runs a stored bank");
  if (!config.archive.bank.empty() && !config.archive.input.empty())
    throw ConfigurationError("archive.bank and archive.input: give one of them");
  for (const std::string& file : {config.archive.input, config.archive.bank, config.mixture.start_file})
    if (!file.empty() && !std::filesystem::exists(file))
      throw ConfigurationError(fmt::format("{}: no such file", file));
}

/// An archive must not take the place of what it was made from.
void check_output(const CommandLine& line, const Config& config) {
  if (!std::filesystem::exists(config.archive.output)) return;
  const auto require_other = [&](const std::filesystem::path& file) {
    std::error_code absent;
    if (std::filesystem::equivalent(file, config.archive.output, absent))
      throw ConfigurationError(fmt::format("archive.output: {} is read by this run; name another file", file.string()));
  };
  require_other(line.files.front());
  for (const std::string& file : {config.archive.input, config.archive.bank, config.mixture.start_file})
    if (!file.empty()) require_other(file);
  if (!config.archive.input.empty()) return;
  for (const std::filesystem::path& file : data_files(config.data)) require_other(file);
}

void data_stage(const std::string& command, const Config& config, Archive& archive) {
  if (config.archive.input.empty())
    import_stage(config, archive);
  else
    take_earlier_stages(config, command, archive);
}

void run_stages(const std::string& command, const Config& config, Archive& archive) {
  if (!config.archive.bank.empty()) {
    load_banks(config, archive);
    evaluate_stage(config, archive);
    return;
  }
  if (!archive.windows) identify_stage(config, archive);
  if (command == "identify") return;
  if (!archive.mixture) cluster_stage(config, archive);
  if (command == "cluster") return;
  bank_stage(config, archive);
  evaluate_stage(config, archive);
}

}  // namespace

int run_pipeline(const CommandLine& line) {
  if (line.files.size() != 1)
    throw ConfigurationError(
        fmt::format("{} needs one configuration file: modebank {} CONFIG", line.command, line.command));
  const Config config = load_config(line.files.front(), line.overrides);
  check_usage(line, config);
  validate(config);
  check_writable(config.archive.output);
  check_output(line, config);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, config.job.thread_count());

  Archive archive;
  archive.config = resolved_text(config);
  archive.provenance = make_provenance(config, line);
  data_stage(line.command, config, archive);
  std::string summary;
  if (line.command == "identify" && streams_windows(config, archive)) {
    summary = identify_into_file(config, archive);
  } else {
    run_stages(line.command, config, archive);
    residual_test_stage(config, archive);
    write_archive(config.archive.output, archive);
    summary = summary_text(archive);
  }
  fmt::print("{}\narchive {}\n", summary, config.archive.output);
  return 0;
}

}  // namespace modebank::app
