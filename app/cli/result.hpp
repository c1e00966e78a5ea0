#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "app/cli/command_line.hpp"

/// Result of a command on standard output: text, or one JSON object with --json. docs/reference/json.md lists the
/// members of each command's object.
namespace modebank::app {

/// Prints nothing with --json. Control characters in names are printed as \x1b.
void print_text(const CommandLine& line, std::string_view text);

/// Prints the JSON object, only with --json. Adds `command`, `modebank` (its version) and `status` to the members.
void print_json(const CommandLine& line, nlohmann::json members, int status = 0);

/// Result of a command. It is printed by this command, or by another command that calls this one.
struct Result {
  std::string text;
  nlohmann::json members;
};

/// Prints the result and returns the exit status 0.
int print_result(const CommandLine& line, const Result& result);

/// With --json, prints the error as a JSON object with the member `error`, unless the command has already printed an
/// object.
void print_json_error(const std::string& command, const std::string& error, int status);

}  // namespace modebank::app
