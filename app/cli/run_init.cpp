#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/cli/commands.hpp"
#include "app/cli/init_trial.hpp"
#include "app/cli/log/log_sets.hpp"
#include "app/cli/result.hpp"
#include "app/config/config_file.hpp"
#include "app/init/init_json.hpp"
#include "app/init/proposal.hpp"
#include "app/init/survey_set.hpp"
#include "app/init/survey_text.hpp"
#include "ident/base/printable.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

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
