#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>

#include "app/cli/commands.hpp"
#include "app/cli/result.hpp"
#include "app/view/child.hpp"
#include "app/view/digest.hpp"
#include "app/view/server.hpp"
#include "io/files/standard_error.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// In the user's browser, which is not ours to wait for.
void open_in_browser(const std::string& address) {
  const pid_t process = ::fork();
  if (process < 0) return;
  if (process > 0) {
    ::waitpid(process, nullptr, 0);
    return;
  }
  if (::fork() == 0) {
    ::setsid();
    view::hand_on_nothing();
    ::execlp("xdg-open", "xdg-open", address.c_str(), static_cast<char*>(nullptr));
    say("modebank: cannot open a browser: xdg-open is missing (Debian package xdg-utils)\n");
  }
  ::_exit(0);
}

}  // namespace

int run_view(const CommandLine& line) {
  if (line.files.size() != 1)
    throw ConfigurationError("view needs an archive or a folder of archives: modebank view ARCHIVE|FOLDER");
  const std::string& what = line.files.front();
  if (line.json) {
    for (const std::string& option : line.given)
      if (option == "open" || option == "port")
        throw ConfigurationError(fmt::format("--{}: view --json prints and stops, so nothing is served", option));
    print_json(line, view::digest_of(what));
    return 0;
  }
  if (line.port < 0 || line.port > 65535) throw ConfigurationError("--port: allowed are 0 to 65535");
  bool first = true;
  view::ServerOptions options;
  options.port = static_cast<unsigned short>(line.port);
  options.announce = [&](const std::string& address) {
    fmt::print("{}{}\n", first ? "Ctrl-C ends it. This address opens once:\n" : "and for another browser: ", address);
    std::fflush(stdout);
    if (first && line.open) open_in_browser(address);
    first = false;
  };
  view::serve(what, options);
  return 0;
}

}  // namespace modebank::app
