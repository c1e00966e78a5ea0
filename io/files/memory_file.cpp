#include "io/files/memory_file.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "io/files/read_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

MemoryFile::MemoryFile() : descriptor_(memfd_create("modebank", MFD_CLOEXEC)) {
  if (descriptor_ < 0) throw DataError("cannot make a file in memory: " + std::generic_category().message(errno));
}

MemoryFile::~MemoryFile() { ::close(descriptor_); }

std::filesystem::path MemoryFile::path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

std::string MemoryFile::content() const { return read_file(path()); }

}  // namespace modebank
