#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "app/cli/command_line.hpp"
#include "app/cli/commands.hpp"
#include "app/cli/log.hpp"
#include "ident/base/printable.hpp"
#include "io/files/standard_error.hpp"
#include "modebank/base/error.hpp"

namespace {

constexpr int usage_error = 2;
constexpr int run_failure = 1;

int fail(int status, const char* what) {
  modebank::say(fmt::format("modebank: {}\n", modebank::printable(what)));
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  modebank::occupy_standard_streams();
  modebank::app::set_up_log(modebank::app::Verbosity::normal);
  try {
    const int status = modebank::app::run_command(modebank::app::parse_command_line(argc, argv));
    // A full disk or a closed pipe must not pass for success.
    return std::fflush(stdout) == 0 ? status : fail(run_failure, "cannot write the results to standard output");
  } catch (const modebank::ConfigurationError& error) {
    return fail(usage_error, error.what());
  } catch (const std::exception& error) {
    return fail(run_failure, error.what());
  }
}
