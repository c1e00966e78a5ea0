#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "app/cli/command_line.hpp"

/// What a command ends with, on standard output: text for people, or with --json one object for programs. The members
/// of each command's object stand in docs/reference/json.md.
namespace modebank::app {

/// Nothing with --json. Control characters of names in it are shown as \x1b.
void print_text(const CommandLine& line, std::string_view text);

/// Nothing without --json. To the members that the command has come `command`, `modebank` (its version) and `status`.
void print_json(const CommandLine& line, nlohmann::json members, int status = 0);

/// What a command found, to be printed by it or by another that it is a part of.
struct Result {
  std::string text;
  nlohmann::json members;
};

/// Prints it. Returns the exit status 0.
int print_result(const CommandLine& line, const Result& result);

/// What went wrong, where --json was asked for: the same object with `error` alone, unless the command has said it in
/// an object of its own.
void print_json_error(const std::string& command, const std::string& error, int status);

}  // namespace modebank::app
