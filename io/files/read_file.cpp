#include "io/files/read_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "modebank/base/error.hpp"

namespace modebank {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::error_code& error) {
  throw ConfigurationError("cannot read " + path.string() + ": " + error.message());
}

}  // namespace

std::ifstream open_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) fail(path, std::make_error_code(std::errc::is_a_directory));
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail(path, {errno, std::generic_category()});
  return stream;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream stream = open_file(path);
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error) fail(path, error);
  std::string content(bytes, '\0');
  stream.read(content.data(), static_cast<std::streamsize>(bytes));
  if (stream.bad()) fail(path, std::make_error_code(std::errc::io_error));
  content.resize(static_cast<std::size_t>(stream.gcount()));
  return content;
}

std::size_t read_at(int descriptor, char* to, std::size_t count, std::uintmax_t offset, std::error_code& error) {
  std::size_t done = 0;
  while (done < count) {
    const ssize_t got = ::pread(descriptor, to + done, count - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) error.assign(errno, std::generic_category());
    if (got <= 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

void refuse_special_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) return;
  if (status.type() == std::filesystem::file_type::none) throw DataError(path.string() + ": " + error.message());
  if (!std::filesystem::is_regular_file(status)) throw DataError(path.string() + ": is not a regular file");
}

}  // namespace modebank
