#include <fmt/format.h>
#include <unistd.h>

#include <boost/algorithm/string/trim.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/cli/commands.hpp"
#include "app/cli/init_trial.hpp"
#include "app/cli/result.hpp"
#include "app/config/config_file.hpp"
#include "app/config/configuration_output.hpp"
#include "app/init/confirm.hpp"
#include "app/init/init_json.hpp"
#include "app/init/proposal.hpp"
#include "app/init/survey_set.hpp"
#include "app/init/survey_text.hpp"
#include "ident/base/printable.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// Of the inputs' files, beside where the program is called: pro_*.csv gives pro.ini.
std::string default_name(const std::vector<FileSet>& sets) {
  const FileSet& first = sets.front();
  std::string stem =
      (first.pattern.empty() ? first.files.front() : std::filesystem::path(first.pattern)).stem().string();
  stem = stem.substr(0, stem.find('*'));
  while (!stem.empty() && (stem.back() == '_' || stem.back() == '-' || stem.back() == '.')) stem.pop_back();
  return (stem.empty() ? "log" : stem) + ".ini";
}

/// Of data.inputs and data.states, which are lists of patterns: what would read as something else in them.
void refuse_unnameable(const std::vector<FileSet>& sets) {
  for (const FileSet& set : sets)
    for (const std::filesystem::path& file : set.files) {
      const std::string name = file.filename().string();
      if (name_holds_controls(name) || boost::trim_copy(name) != name || name.find_first_of("#,*") != std::string::npos)
        throw ConfigurationError(
            fmt::format("{}: no configuration can name it: it holds a comma, a '#', a '*', a blank at an end or a "
                        "control character; rename it",
                        printable_name(file.string())));
    }
}

/// Whether someone can answer.
bool is_asked(const CommandLine& line) {
  return !line.yes && !line.json && isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1;
}

}  // namespace

int run_init(const CommandLine& line) {
  const std::vector<FileSet> sets = file_sets(line.files);
  refuse_unnameable(sets);
  const std::string target = line.output.empty() ? default_name(sets) : line.output;
  std::vector<std::filesystem::path> sources;
  for (const FileSet& set : sets) sources.insert(sources.end(), set.files.begin(), set.files.end());
  check_configuration_output("-o", target, sources, line.force);
  std::vector<SurveyedFile> surveyed;
  for (const FileSet& set : sets) surveyed.push_back(survey_set(set));
  print_text(line, survey_text(sets, surveyed));
  const std::filesystem::path folder = std::filesystem::absolute(target).lexically_normal().parent_path();
  Guess guess = guess_roles(surveyed);
  if (is_asked(line)) confirm_roles(surveyed, guess, std::cin, std::cout);
  Proposal proposal = propose(sets, surveyed, guess, folder.string());
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
