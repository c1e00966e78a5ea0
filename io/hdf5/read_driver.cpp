#include "io/hdf5/read_driver.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <limits>
#include <memory>
#include <type_traits>

namespace modebank::hdf5 {

namespace {

/// What HDF5 knows of an open file first, then ours.
struct OpenFile {
  H5FD_t known{};
  int descriptor = -1;
  haddr_t size = 0, end = 0;  ///< of the file; of what HDF5 uses of it
  dev_t device = 0;
  ino_t number = 0;
};
static_assert(std::is_standard_layout_v<OpenFile>);

OpenFile& ours(H5FD_t* file) { return *reinterpret_cast<OpenFile*>(file); }
const OpenFile& ours(const H5FD_t* file) { return *reinterpret_cast<const OpenFile*>(file); }

H5FD_t* open_for_reading(const char* name, unsigned flags, hid_t, haddr_t) {
  if (flags != H5F_ACC_RDONLY) return nullptr;
  auto file = std::make_unique<OpenFile>();
  file->descriptor = ::open(name, O_RDONLY | O_CLOEXEC);
  struct stat about {};
  if (file->descriptor < 0) return nullptr;
  if (::fstat(file->descriptor, &about) != 0) {
    ::close(file->descriptor);
    return nullptr;
  }
  file->size = static_cast<haddr_t>(about.st_size);
  file->device = about.st_dev;
  file->number = about.st_ino;
  return &file.release()->known;
}

herr_t close_file(H5FD_t* file) {
  const std::unique_ptr<OpenFile> owned(&ours(file));
  return ::close(owned->descriptor);
}

int compare(const H5FD_t* a, const H5FD_t* b) {
  const OpenFile &left = ours(a), &right = ours(b);
  if (left.device != right.device) return left.device < right.device ? -1 : 1;
  return left.number == right.number ? 0 : left.number < right.number ? -1 : 1;
}

herr_t read_all(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t count, void* buffer) {
  const OpenFile& opened = ours(file);
  if (at > opened.size || count > opened.size - at) return -1;
  for (char* to = static_cast<char*>(buffer); count > 0;) {
    const ssize_t got = ::pread(opened.descriptor, to, count, static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return -1;
    to += got;
    at += static_cast<haddr_t>(got);
    count -= static_cast<std::size_t>(got);
  }
  return 0;
}

H5FD_class_t description() {
  H5FD_class_t driver{};
  driver.name = "modebank";
  driver.maxaddr = static_cast<haddr_t>(std::numeric_limits<off_t>::max());
  driver.fc_degree = H5F_CLOSE_WEAK;
  driver.open = open_for_reading;
  driver.close = close_file;
  driver.cmp = compare;
  driver.query = [](const H5FD_t*, unsigned long* features) -> herr_t {
    if (features) *features = H5FD_FEAT_DATA_SIEVE;  // of raw data alone; metadata are not gathered
    return 0;
  };
  driver.get_eoa = [](const H5FD_t* file, H5FD_mem_t) { return ours(file).end; };
  driver.set_eoa = [](H5FD_t* file, H5FD_mem_t, haddr_t end) -> herr_t {
    ours(file).end = end;
    return 0;
  };
  driver.get_eof = [](const H5FD_t* file, H5FD_mem_t) { return ours(file).size; };
  driver.get_handle = [](H5FD_t* file, hid_t, void** handle) -> herr_t {
    *handle = &ours(file).descriptor;
    return 0;
  };
  driver.read = read_all;
  driver.write = [](H5FD_t*, H5FD_mem_t, hid_t, haddr_t, std::size_t, const void*) -> herr_t { return -1; };
  constexpr H5FD_mem_t kinds[] = H5FD_FLMAP_SINGLE;
  for (int kind = 0; kind < H5FD_MEM_NTYPES; ++kind) driver.fl_map[kind] = kinds[kind];
  return driver;
}

}  // namespace

hid_t read_driver() {
  static const H5FD_class_t driver = description();
  static const hid_t id = H5FDregister(&driver);
  return id;
}

}  // namespace modebank::hdf5
