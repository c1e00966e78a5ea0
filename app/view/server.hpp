#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace modebank::app::view {

struct ServerOptions {
  unsigned short port = 0;  ///< 0: the kernel's choice
  /// Given each address that opens, when it begins to.
  std::function<void(const std::string& address)> announce;
};

/// Serves an archive or a folder of archives on 127.0.0.1 until SIGINT, SIGTERM or SIGHUP. Throws ConfigurationError
/// when there is no such archive or folder, or the port is taken.
void serve(const std::filesystem::path& what, const ServerOptions& options);

}  // namespace modebank::app::view
