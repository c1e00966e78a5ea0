#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/cli/commands.hpp"
#include "app/cli/result.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app {
namespace {

using nlohmann::json;

/// The problem as text. The file's name is put in front, unless the text already begins with the name.
std::string named_problem(const std::string& file, const std::string& what) {
  return what.rfind(file + ": ", 0) == 0 ? what : fmt::format("{}: {}", file, what);
}

/// Problems of one archive.
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

}  // namespace

int run_verify(const CommandLine& line) {
  json files = json::array();
  bool all_good = true;
  for (const std::string& file : line.files) {
    files.push_back(report_archive(line, file));
    all_good = all_good && files.back()["problems"].empty();
  }
  print_json(line, {{"files", files}}, all_good ? 0 : 1);
  return all_good ? 0 : 1;
}

}  // namespace modebank::app
