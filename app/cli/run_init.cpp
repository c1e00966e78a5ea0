#include <fmt/format.h>

#include <functional>
#include <stdexcept>
#include <vector>

#include "app/cli/commands.hpp"
#include "app/cli/init_trial.hpp"
#include "app/cli/log/log_sets.hpp"
#include "app/config/config_file.hpp"
#include "app/config/ini_lines.hpp"
#include "app/config/option_table.hpp"
#include "app/init/init_json.hpp"
#include "app/init/proposal.hpp"
#include "app/init/survey_set.hpp"
#include "app/init/survey_text.hpp"
#include "filter/learn/chain/inputs.hpp"
#include "ident/base/printable.hpp"
#include "ident/fit/fit_windows.hpp"
#include "io/files/replace_file.hpp"
#include "io/import/import.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

namespace fs = std::filesystem;

void import_and_cut(const Config& config) {
  DataOptions data = data_options_of(config);
  data.lag_auto = false;
  const ImportedData imported = import_data(data);
  refuse_constant_states(imported.recording);
  if (count_windows(imported.recording, config.window) == 0)
    throw DataError(fmt::format("no training run has the {} transitions of a window", config.window.length));
}

struct Remedy {
  std::string words;
  std::function<bool(Proposal&)> apply;  ///< returns false if there is nothing to change
};

std::vector<Remedy> remedies() {
  const auto dropped = [](const std::string& key) {
    return [key](Proposal& proposal) {
      const bool there = proposal.find(key) != nullptr;
      proposal.drop(key);
      return there;
    };
  };
  const auto set = [](const std::string& key, const std::string& value, const std::string& why) {
    return [=](Proposal& proposal) {
      const ProposedKey* const now = proposal.find(key);
      if (now != nullptr && now->value == value) return false;
      proposal.set(key, value, why);
      return true;
    };
  };
  return {
      {"rows keep their own rate",
       [=](Proposal& proposal) {
         const ProposedKey* const time =
             proposal.find("time");  // without a column of times, the configuration states the rate
         return (time == nullptr || time->value != " ") && dropped("rate_hz")(proposal);
       }},
      {"rows are sorted by time", set("disorder", "sort", "times repeat or go backwards")},
      {"runs are split where values are missing", set("missing", "gap", "some values are missing")},
      {"no column separates runs",
       [=](Proposal& proposal) {
         return dropped("run")(proposal) && set("split", "last 30 %", "its end is held out")(proposal);
       }},
      {"the last 30 % are held out",
       [=](Proposal& proposal) {
         return proposal.find("split") != nullptr && set("split", "last 30 %", "its end is held out")(proposal);
       }},
      {"nothing is held out", dropped("split")},
  };
}

}  // namespace

std::string refusal(const Proposal& proposal, const fs::path& target) {
  try {
    const Config config = config_of_text(configuration_text(proposal, "modebank init"), target, {});
    validate(config);
    import_and_cut(config);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

void state_values(Proposal& proposal) {
  std::erase_if(proposal.keys, [](const ProposedKey& key) { return find_option("data." + key.key) == nullptr; });
  for (ProposedKey& key : proposal.keys)
    if (takes_quotes("data." + key.key) && key.value != " ") key.value = path_text(key.value);
}

void make_it_run(Proposal& proposal, const fs::path& target) {
  const std::string first = refusal(proposal, target);
  if (first.empty()) return;
  const auto take_if_it_runs = [&](Proposal changed, const std::string& words) {
    if (!refusal(changed, target).empty()) return false;
    changed.doubt(fmt::format("{}, because run would end in: {}", words, first));
    proposal = std::move(changed);
    return true;
  };
  const std::vector<Remedy> all = remedies();
  for (const Remedy& remedy : all)  // only the first change that helps is kept
    if (Proposal changed = proposal; remedy.apply(changed) && take_if_it_runs(changed, remedy.words)) return;
  Proposal changed = proposal;
  std::string words;
  for (const Remedy& remedy : all) {
    if (!remedy.apply(changed)) continue;
    words += (words.empty() ? "" : ", ") + remedy.words;
    if (take_if_it_runs(changed, words)) return;
  }
  throw DataError(fmt::format("no configuration is written, because run would end in: {}", first));
}

int run_init(const CommandLine& line) {
  const std::vector<FileSet> sets = nameable_sets(line.files);
  const std::string target = line.output.empty() ? name_after(sets) + ".ini" : line.output;
  check_configuration_output("-o", target, files_of(sets), line.force);
  std::vector<SurveyedFile> surveyed;
  for (const FileSet& set : sets) surveyed.push_back(survey_set(set));
  print_text(line, survey_text(sets, surveyed));
  const std::filesystem::path folder = std::filesystem::absolute(target).lexically_normal().parent_path();
  Proposal proposal = propose(sets, surveyed, guess_roles(surveyed), folder.string());
  state_values(proposal);
  make_it_run(proposal, target);
  const std::string text = configuration_text(proposal, line.typed);
  replace_file(final_target(target), {text});
  print_text(line, fmt::format("\n{}:\n{}\n", target, text));
  const std::string archive = std::filesystem::path(target).stem().string() + ".h5";
  print_text(line, fmt::format("next: {0} run {1}\nthen: {0} report {2}\n", line.program, shell_quoted(target),
                               shell_quoted(archive)));
  nlohmann::json result = init_json(surveyed, proposal);
  result["written"] = {target};
  print_json(line, result);
  return 0;
}

}  // namespace modebank::app
