#include "io/hdf5/read_at.hpp"

#include <unistd.h>

#include <cerrno>

namespace modebank::hdf5 {

std::optional<std::size_t> read_at(int descriptor, haddr_t at, std::size_t count, char* to) {
  std::size_t done = 0;
  while (done < count) {
    const ssize_t got = ::pread(descriptor, to + done, count - done, static_cast<off_t>(at + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return std::nullopt;
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

}  // namespace modebank::hdf5
