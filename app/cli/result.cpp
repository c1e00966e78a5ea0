#include "app/cli/result.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "app/chain/build_info.hpp"
#include "ident/base/printable.hpp"

namespace modebank::app {
namespace {

using nlohmann::json;

bool printed = false;  ///< whether the process has printed its JSON object

void print(json object, const std::string& command, int status) {
  printed = true;
  object["command"] = command;
  object["modebank"] = build_info::version;
  object["status"] = status;
  // Names come from files, so they may contain bytes that are not UTF-8. These bytes are replaced.
  fmt::print("{}\n", object.dump(2, ' ', false, json::error_handler_t::replace));
}

}  // namespace

void print_text(const CommandLine& line, std::string_view text) {
  if (line.json) return;
  fmt::print("{}", printable(text));
  std::fflush(stdout);
}

void print_json(const CommandLine& line, json members, int status) {
  if (line.json) print(std::move(members), line.command, status);
}

int print_result(const CommandLine& line, const Result& result) {
  print_text(line, result.text);
  print_json(line, result.members);
  return 0;
}

void print_json_error(const std::string& command, const std::string& error, int status) {
  if (!printed) print({{"error", error}}, command, status);
}

}  // namespace modebank::app
