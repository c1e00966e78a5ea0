#include "app/cli/log.hpp"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>
#include <string_view>

#include "ident/base/printable.hpp"

namespace modebank::app {
namespace {

/// Prefix of a message: "warning: " in the level's colour for a warning, nothing for progress.
class Mark : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
    if (message.level < spdlog::level::warn) return;
    message.color_range_start = out.size();
    append(out, message.level == spdlog::level::warn ? "warning:" : "error:");
    message.color_range_end = out.size();
    append(out, " ");
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<Mark>(); }

 private:
  static void append(spdlog::memory_buf_t& out, std::string_view text) {
    out.append(text.data(), text.data() + text.size());
  }
};

/// Control characters in names from files are escaped, because a terminal would execute them.
class Message : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
    const std::string text = printable({message.payload.data(), message.payload.size()});
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<Message>(); }
};

bool colours_wanted() {
  const char* no_color = std::getenv("NO_COLOR");
  return no_color == nullptr || *no_color == '\0';
}

}  // namespace

std::string error_mark() {
  const char* terminal = std::getenv("TERM");
  const bool coloured =
      colours_wanted() && isatty(STDERR_FILENO) == 1 && terminal != nullptr && std::string_view(terminal) != "dumb";
  return coloured ? "\x1b[1;31mmodebank:\x1b[0m" : "modebank:";
}

void set_up_log(Verbosity verbosity) {
  auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>(colours_wanted() ? spdlog::color_mode::automatic
                                                                                     : spdlog::color_mode::never);
  auto logger = std::make_shared<spdlog::logger>("modebank", std::move(sink));
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<Mark>('*').add_flag<Message>('#').set_pattern(
      isatty(STDERR_FILENO) == 1 ? "%*%#\x1b[K" : "%*%#");  // erases the rest of the line of a progress meter
  logger->set_formatter(std::move(formatter));
  logger->set_level(verbosity == Verbosity::quiet      ? spdlog::level::err
                    : verbosity == Verbosity::warnings ? spdlog::level::warn
                    : verbosity == Verbosity::normal   ? spdlog::level::info
                                                       : spdlog::level::debug);
  spdlog::set_default_logger(std::move(logger));
}

}  // namespace modebank::app
