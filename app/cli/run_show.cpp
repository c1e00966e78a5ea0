#include <fmt/format.h>

#include "app/cli/commands.hpp"
#include "app/config/config_file.hpp"
#include "app/text/csv_text.hpp"
#include "app/text/first_screen.hpp"
#include "app/text/free_run_text.hpp"
#include "app/text/mode_tables.hpp"
#include "app/text/number_text.hpp"
#include "app/text/summary_tables.hpp"
#include "app/text/summary_text.hpp"
#include "app/text/terminal.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/inspect.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

using nlohmann::json;

void print_overview(const CommandLine& line) {
  const OpenArchive file(line.files[0]);
  const bool full_form = line.form == "full";
  const int width = standard_output().width;
  const Archive archive = read_archive(file, Evaluations::in_file);
  if (has_first_screen(archive))
    fmt::print("{}\n", first_screen(archive, resolved_values(archive.config), line.files[0], width, line.program));
  fmt::print("{}\n{}", wrapped(provenance_text(archive), width),
             summary_text(archive, time_unit(resolved_values(archive.config)), width));
  fmt::print("{}", wrapped(free_run_text(archive, width), width));
  if (archive.mixture) fmt::print("\ncandidates\n{}", candidates_text(*archive.mixture, width));
  if (archive.bank) fmt::print("\nmodes\n{}", modes_text(archive, full_form, width));
  if (archive.nonlinear)
    fmt::print("\none nonlinear motion (competitor nonlinear)\n{}", equations_text(archive, width));
  fmt::print("{}{}", modes_in_words(archive, width, time_unit(resolved_values(archive.config))),
             mode_diagnostics_text(archive, width));
}

/// Adds I to A in the datasets of A (K, n, n).
void add_identity(json& matrices) {
  for (json& matrix : matrices)
    for (std::size_t i = 0; i < matrix.size(); ++i) matrix[i][i] = matrix[i][i].get<double>() + 1.0;
}

/// Adds I to rows of theta = vec of [A B (c)]. Entry (i, i) of A has the index i (q + 1).
void add_identity_to_theta(json& rows, const LinearStructure& structure) {
  for (json& row : rows)
    for (Index i = 0; i < structure.states; ++i) {
      json& entry = row[static_cast<std::size_t>(i * (structure.regressors() + 1))];
      entry = entry.get<double>() + 1.0;
    }
}

void convert_to_full_form(const OpenArchive& file, const std::string& path, json& object) {
  const std::string name = path.substr(path.find_last_of('/') + 1);
  if (name == "A") {
    add_identity(object["value"]);
  } else if (name == "parameters") {
    const Archive archive = read_archive(file, Evaluations::in_file);
    const LinearStructure structure = archive.windows ? archive.windows->structure : archive.bank.value().structure;
    const bool one_row = object["shape"].size() == 1;
    json rows = one_row ? json::array({object["value"]}) : object["value"];
    add_identity_to_theta(rows, structure);
    object["value"] = one_row ? rows[0] : rows;
  } else {
    throw ConfigurationError(path + ": --form full works with A and parameters only");
  }
  object["form"] = "full";
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

}  // namespace

int run_show(const CommandLine& line) {
  if (line.files.size() == 1 && !line.json && !line.csv && line.run.empty()) {
    print_overview(line);
    return 0;
  }
  const std::string path = line.files.size() == 2 ? line.files[1] : "/";
  const OpenArchive file(line.files[0]);
  json object = inspect(file, path, line.run);
  if (line.form == "full") convert_to_full_form(file, path, object);
  if (line.csv && !line.run.empty() && object.contains("members"))
    object = samples_of(file, path, line.run, object.at("members"));
  if (line.csv)
    fmt::print("{}", csv_text(object, path));
  else if (line.json)
    print_json(line, object);
  else
    fmt::print("{}\n", object.dump(2));
  return 0;
}

namespace {

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
