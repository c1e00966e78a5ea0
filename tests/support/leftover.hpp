#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>

#include "io/files/temporary_file.hpp"

namespace modebank::test {

/// Creates the temporary file of a process that was killed two days ago, and returns its path.
inline std::filesystem::path leave_behind(const std::filesystem::path& target) {
  const std::filesystem::path path = temporary_path(target);
  std::ofstream(path) << "half";
  std::filesystem::last_write_time(path, std::filesystem::file_time_type::clock::now() - std::chrono::hours(48));
  return path;
}

}  // namespace modebank::test
