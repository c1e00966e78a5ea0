#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "io/files/temporary_file.hpp"

namespace modebank::test {

/// The temporary file of a process that has ended without taking it away; its path.
inline std::filesystem::path leave_behind(const std::filesystem::path& target) {
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = ::fork();
  if (child == 0) {
    const std::string path = temporary_path(target).string();
    std::ofstream(path) << "half";
    const bool told = ::write(ends[1], path.data(), path.size()) == static_cast<ssize_t>(path.size());
    ::_exit(told ? 0 : 1);
  }
  ::close(ends[1]);
  std::string path(4096, '\0');
  const ssize_t length = ::read(ends[0], path.data(), path.size());
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  if (child < 0 || length <= 0 || status != 0) throw std::runtime_error("the child left nothing");
  path.resize(static_cast<std::size_t>(length));
  return path;
}

}  // namespace modebank::test
