#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "app/cli/command_line.hpp"

/// A command's result on standard output: text for people, or with --json one object for programs.
/// docs/reference/json.md lists the members of each command's object.
namespace modebank::app {

/// Prints nothing with --json. Control characters in names are printed as \x1b.
void print_text(const CommandLine& line, std::string_view text);

/// Prints nothing without --json. Adds `command`, `modebank` (its version) and `status` to the members.
void print_json(const CommandLine& line, nlohmann::json members, int status = 0);

/// Result of a command, to be printed by it or by a command that includes it.
struct Result {
  std::string text;
  nlohmann::json members;
};

/// Prints the result and returns the exit status 0.
int print_result(const CommandLine& line, const Result& result);

/// With --json prints the error as the same object with `error` alone, unless the command has printed an object
/// already.
void print_json_error(const std::string& command, const std::string& error, int status);

}  // namespace modebank::app
