#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <string>

#include "app/cli/command_line.hpp"
#include "app/cli/commands.hpp"
#include "ident/base/characters.hpp"
#include "modebank/base/error.hpp"

namespace {

constexpr int usage_error = 2;
constexpr int run_failure = 1;

/// What names in files and options hold is shown, not obeyed. That nobody can read the message is no second failure.
int fail(int status, const std::string& what) {
  const std::string message = "modebank: " + modebank::printable(what, true) + "\n";
  std::fputs(message.c_str(), stderr);
  return status;
}

/// The same for every line of the log.
class PrintableMessage : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& to) override {
    const std::string text = modebank::printable({message.payload.data(), message.payload.size()}, true);
    to.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<PrintableMessage>(); }
};

void start_log() {
  spdlog::set_default_logger(spdlog::stderr_color_mt("modebank"));
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<PrintableMessage>('*').set_pattern("%*");
  spdlog::set_formatter(std::move(formatter));
}

}  // namespace

int main(int argc, char** argv) {
  start_log();
  try {
    const int status = modebank::app::run_command(modebank::app::parse_command_line(argc, argv));
    // A full disk or a closed pipe must not pass for success.
    return std::fflush(stdout) == 0 ? status : fail(run_failure, "cannot write the results to standard output");
  } catch (const modebank::ConfigurationError& error) {
    return fail(usage_error, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(run_failure, error.path1().string() + ": " + error.code().message());
  } catch (const std::bad_alloc&) {
    return fail(run_failure, "this needs more memory than there is");
  } catch (const std::exception& error) {
    return fail(run_failure, error.what());
  }
}
