#include "app/cli/log/run_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string/trim.hpp>
#include <filesystem>

#include "app/cli/acting_doubts.hpp"
#include "app/cli/commands.hpp"
#include "app/cli/init_trial.hpp"
#include "app/cli/log/joined_inputs.hpp"
#include "app/cli/log/log_configuration.hpp"
#include "app/cli/log/log_outputs.hpp"
#include "app/cli/log/log_sets.hpp"
#include "app/cli/log/log_text.hpp"
#include "app/cli/log/same_runs.hpp"
#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "app/init/init_json.hpp"
#include "app/init/survey_set.hpp"
#include "app/report/page/run_page.hpp"
#include "app/report/page/write_page.hpp"
#include "app/text/structure_text.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

namespace fs = std::filesystem;

bool is_log(const fs::path& path) {
  if (fs::is_directory(path)) return true;
  if (path.extension() == ".ini" || !fs::is_regular_file(path)) return false;
  return looks_like_log(path) || !is_configuration(path);
}

/// Throws for keys that `run LOG` itself sets from the logs.
void refuse_keys(const KeyValues& overrides) {
  for (const auto& [key, value] : overrides)
    for (const char* const decided : {"data.root", "data.inputs", "data.states", "data.truth", "archive.bank"})
      if (key == decided)
        throw ConfigurationError(fmt::format(
            "--{}: the logs that `modebank run LOG...` names decide that; write a configuration for it: modebank init "
            "LOG...",
            key));
}

/// Copies the keys of the command line into the proposal, in the form of the configuration file.
void take_data_keys(const KeyValues& overrides, Proposal& proposal) {
  for (const auto& [key, value] : overrides) {
    if (!key.starts_with("data.")) continue;
    const auto name = key.substr(5), stated = boost::trim_copy(value);
    std::erase_if(proposal.doubts, [&key = key](const auto& doubt) {  // what is stated is no doubt
      return doubt.find(key + " ") != std::string::npos || doubt.find(key + ")") != std::string::npos;
    });
    if (name != "derive") proposal.drop(name);  // each line of it makes another channel
    proposal.drop(name + "_unit");
    proposal.add(name, stated.empty() ? " " : stated, "from the command line");
  }
}

void take_other_keys(const KeyValues& overrides, LogConfiguration& configuration) {
  for (const auto& [key, value] : overrides)
    if (!key.starts_with("data.") && key != "archive.output")
      configuration.set(key, boost::trim_copy(value), "from the command line");
}

/// The logs, and the guesses of `init` from them before any fit.
struct LookedInto {
  std::vector<FileSet> sets;
  std::vector<SurveyedFile> surveyed;
  Guess guess;
};

LookedInto look_into(std::vector<FileSet> sets) {
  LookedInto logs{std::move(sets), {}, {}};
  for (const FileSet& set : logs.sets) logs.surveyed.push_back(survey_set(set));
  logs.guess = guess_roles(logs.surveyed);
  refuse_other_runs(logs.sets, logs.surveyed, logs.guess);
  return logs;
}

bool states_inputs(const CommandLine& line) {
  return std::any_of(line.overrides.begin(), line.overrides.end(),
                     [](const auto& each) { return each.first == "data.input"; });
}

LogConfiguration configure(const CommandLine& line, const LookedInto& logs, const fs::path& target,
                           const fs::path& archive) {
  const fs::path folder = fs::absolute(target).lexically_normal().parent_path();
  Proposal proposal = propose(logs.sets, logs.surveyed, logs.guess, folder.string());
  if (const std::string doubt = doubt_of_one_run(logs.sets, logs.surveyed, logs.guess); !doubt.empty())
    proposal.doubt(doubt);
  take_data_keys(line.overrides, proposal);
  state_values(proposal);
  make_it_run(proposal, target);
  if (!line.dry_run) leave_out_joined_inputs(target, archive, line.typed, states_inputs(line), proposal);
  LogConfiguration configuration(std::move(proposal), line.typed);
  take_other_keys(line.overrides, configuration);
  return configuration;
}

std::string lag_reason(const LagReport& lag) {
  const auto taken = std::find_if(lag.scores.begin(), lag.scores.end(),
                                  [&](const LagScore& score) { return score.correction == lag.correction; });
  if (lag.correction == LagCorrection::none || taken == lag.scores.end())
    return "no lag gains on training runs left out, so inputs keep their times";
  return fmt::format(
      "inputs act {:+.3f} +- {:.3f} s later than stamped: {:+.3f} +- {:.3f} nats per sample on training "
      "runs left out",
      lag.lag.mean, lag.lag.standard_error, taken->gain, taken->gain_standard_error);
}

/// Adds the results of `run` to the reasons of the keys that caused these results: lag and structure.
void explain_found(const Archive& archive, LogConfiguration& configuration) {
  if (archive.lag) configuration.explain("data.lag_s", lag_reason(*archive.lag));
  if (archive.structure)
    configuration.set("window.model", "auto", structure_sentence(*archive.structure, acted_on(archive)));
}

void write_page_of(const Archive& archive, const LogOutputs& outputs, const CommandLine& line) {
  report::Written written{[](const std::string&) {}, {}};
  report::write_page(
      final_target(outputs.page),
      report::run_page(archive, outputs.archive.filename().string(), stored_config("", line.overrides).report),
      written);
}

std::string written_text(const LogOutputs& outputs) {
  return fmt::format("{:<10}{} opens in a browser; {} has every decision, and `modebank run` repeats it\n", "files",
                     outputs.page.string(), outputs.configuration.string());
}

}  // namespace

bool names_logs(const std::vector<std::string>& files) { return std::any_of(files.begin(), files.end(), is_log); }

Result do_run_log(const CommandLine& line) {
  if (!line.until.empty()) throw ConfigurationError("--until needs a configuration; write one: modebank init LOG...");
  refuse_keys(line.overrides);
  std::vector<FileSet> sets = nameable_sets(line.files);
  const LogOutputs outputs = log_outputs(line, sets);
  check_log_outputs(line, outputs, sets);
  const LookedInto logs = look_into(std::move(sets));
  LogConfiguration configuration = configure(line, logs, outputs.configuration, outputs.archive);
  print_text(line, taken_text(logs.sets, logs.surveyed, logs.guess, configuration.proposal()));
  Result result =
      do_configured(line, configuration.config(outputs.configuration, outputs.archive), outputs.configuration);
  if (line.dry_run) return result;
  const OpenArchive opened(outputs.archive);
  const Archive archive = read_archive(opened, Evaluations::in_file);
  for (const nlohmann::json& doubt : result.members["doubts"]) configuration.doubt(doubt);
  if (!states_inputs(line))
    for (const std::string& doubt : left_channel_doubts(
             archive, configuration.config(outputs.configuration, outputs.archive), configuration.proposal().left)) {
      configuration.doubt(doubt);
      result.text += paragraph("doubt", doubt);
    }
  write_page_of(archive, outputs, line);
  explain_found(archive, configuration);
  replace_file(final_target(outputs.configuration), {configuration.text()});
  result.text += written_text(outputs);
  result.members.update(init_json(logs.surveyed, configuration.proposal()));
  result.members["written"] = {outputs.configuration.string(), outputs.archive.string(), outputs.page.string()};
  return result;
}

}  // namespace modebank::app
