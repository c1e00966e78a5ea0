#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "app/cli/command_line.hpp"
#include "app/cli/commands.hpp"
#include "app/cli/log.hpp"
#include "app/cli/result.hpp"
#include "app/study/run/study_worker.hpp"
#include "ident/base/printable.hpp"
#include "io/files/standard_error.hpp"
#include "modebank/base/error.hpp"

namespace {

constexpr int usage_error = 2;
constexpr int run_failure = 1;

int fail(int status, const char* what) {
  modebank::say(fmt::format("{} {}\n", modebank::app::error_mark(), modebank::printable(what)));
  return status;
}

int fail_to_print(const std::string& reason) {
  return fail(run_failure, ("cannot write the results to standard output: " + reason).c_str());
}

/// Prints an error. With --json it is also printed as JSON.
int fail_as_asked(int argc, char** argv, int status, const char* what) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const auto command = std::find_if(words.begin(), words.end(), [](const std::string& w) { return w[0] != '-'; });
  if (std::find(words.begin(), words.end(), "--json") != words.end())
    modebank::app::print_json_error(command == words.end() ? "" : *command, what, status);
  std::fflush(stdout);
  return fail(status, what);
}

}  // namespace

int main(int argc, char** argv) {
  modebank::occupy_standard_streams();
  if (argc > 1 && std::string_view(argv[1]) == modebank::app::worker_word)
    return modebank::app::run_study_worker(argc, argv);
  try {
    const int status = modebank::app::run_command(modebank::app::parse_command_line(argc, argv));
    // A full disk or a closed pipe is also an error.
    return std::fflush(stdout) == 0 ? status : fail_to_print(std::generic_category().message(errno));
  } catch (const modebank::ConfigurationError& error) {
    return fail_as_asked(argc, argv, usage_error, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    const std::string what = error.path1().string() + ": " + error.code().message();
    return fail_as_asked(argc, argv, run_failure, what.c_str());
  } catch (const std::system_error& error) {  // the exception of fmt does not contain a file name
    return std::ferror(stdout) ? fail_to_print(error.code().message())
                               : fail_as_asked(argc, argv, run_failure, error.what());
  } catch (const std::exception& error) {
    return fail_as_asked(argc, argv, run_failure, error.what());
  }
}
