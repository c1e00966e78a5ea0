#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/cli/commands.hpp"
#include "app/cli/result.hpp"
#include "app/study/answers/verify_study.hpp"
#include "io/archive/archive.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

using nlohmann::json;

/// The problem as text. The file's name is put in front, unless the text already begins with the name.
std::string named_problem(const std::string& file, const std::string& what) {
  return what.rfind(file + ": ", 0) == 0 ? what : fmt::format("{}: {}", file, what);
}

/// Problems of one archive or study, and remarks on it.
json report_archive(const CommandLine& line, const std::string& file) {
  const Verification result = verify_archive(file);
  if (result.ok()) print_text(line, fmt::format("{}: ok\n", file));
  json problems = json::array();
  for (const std::string& problem : result.problems) {
    print_text(line, named_problem(file, problem) + "\n");
    problems.push_back({{"what", problem}});
  }
  return {{"file", file}, {"problems", problems}};
}

json report_study(const CommandLine& line, const std::string& folder) {
  const StudyVerification result = verify_study(folder);
  json problems = json::array();
  for (const StudyProblem& problem : result.problems) {
    const bool removed = line.repair && problem.removable;
    print_text(line, fmt::format("{}{}{}\n", named_problem(problem.file.string(), problem.what),
                                 problem.redo.empty() ? "" : "; to redo: " + problem.redo, removed ? "; removed" : ""));
    problems.push_back(
        {{"file", problem.file.string()}, {"what", problem.what}, {"redo", problem.redo}, {"removed", removed}});
  }
  if (line.repair) repair_study(folder, result);
  print_text(line, fmt::format("{}: {} trials are complete{}\n", folder, result.whole,
                               problems.empty() ? ": ok" : fmt::format(", {} problems", problems.size())));
  return {{"file", folder}, {"problems", problems}, {"whole_trials", result.whole}};
}

}  // namespace

int run_verify(const CommandLine& line) {
  if (line.repair && std::none_of(line.files.begin(), line.files.end(), is_study_folder))
    throw ConfigurationError("--repair works only with folders of studies; " + line.files.front() + " is none");
  json files = json::array();
  bool all_good = true;
  for (const std::string& file : line.files) {
    files.push_back(is_study_folder(file) ? report_study(line, file) : report_archive(line, file));
    all_good = all_good && files.back()["problems"].empty();
  }
  print_json(line, {{"files", files}}, all_good ? 0 : 1);
  return all_good ? 0 : 1;
}

}  // namespace modebank::app
