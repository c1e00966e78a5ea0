#include "io/hdf5/file_driver.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <type_traits>

#include "io/hdf5/handle.hpp"
#include "io/hdf5/header_guard.hpp"
#include "io/hdf5/read_at.hpp"

namespace modebank::hdf5 {

namespace {

/// What HDF5 knows of an open file first, then ours.
struct OpenFile {
  H5FD_t known{};
  int descriptor = -1;
  bool in_the_making = false;
  haddr_t size = 0, end = 0;  ///< of the file; of what HDF5 uses of it
  dev_t device = 0;
  ino_t number = 0;
  HeaderGuard* guard = nullptr;  ///< of what others wrote; ours, as a smart pointer need not have standard layout

  OpenFile() = default;
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { delete guard; }
};
static_assert(std::is_standard_layout_v<OpenFile>);

OpenFile& ours(H5FD_t* file) { return *reinterpret_cast<OpenFile*>(file); }
const OpenFile& ours(const H5FD_t* file) { return *reinterpret_cast<const OpenFile*>(file); }

/// HDF5's reason is the system's, in the words of its own drivers.
herr_t fail(const char* call, H5E_minor_t kind) {
  H5Epush2(H5E_DEFAULT, __FILE__, call, __LINE__, H5E_ERR_CLS, H5E_IO, kind, "%s failed, error message = '%s'", call,
           std::strerror(errno));
  return -1;
}

template <FileOf of>
H5FD_t* open_file_of_ours(const char* name, unsigned flags, hid_t, haddr_t) {
  constexpr mode_t everybody = 0666;
  auto file = std::make_unique<OpenFile>();
  const int changing = ((flags & H5F_ACC_RDWR) != 0 ? O_RDWR : O_RDONLY) |
                       ((flags & H5F_ACC_TRUNC) != 0 ? O_TRUNC : 0) | ((flags & H5F_ACC_CREAT) != 0 ? O_CREAT : 0);
  file->descriptor = ::open(name, changing | O_CLOEXEC, everybody);
  struct stat about {};
  if (file->descriptor < 0) {
    fail("open", H5E_CANTOPENFILE);
    return nullptr;
  }
  if (::fstat(file->descriptor, &about) != 0) {
    ::close(file->descriptor);
    return nullptr;
  }
  file->in_the_making = (flags & H5F_ACC_RDWR) != 0;
  file->size = static_cast<haddr_t>(about.st_size);
  file->device = about.st_dev;
  file->number = about.st_ino;
  if (!file->in_the_making) file->guard = new HeaderGuard(file->descriptor, file->size, of);
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

herr_t read_bytes(const OpenFile& opened, haddr_t at, std::size_t count, char* to) {
  if (!opened.in_the_making && (at > opened.size || count > opened.size - at)) return -1;
  const std::optional<std::size_t> got = read_at(opened.descriptor, at, count, to);
  if (!got || (*got < count && !opened.in_the_making)) return -1;
  std::memset(to + *got, 0, count - *got);  // room that HDF5 has taken and not yet written to
  return 0;
}

/// HDF5 gets no object header that it would read beyond; the reason is then its innermost one.
herr_t judge(OpenFile& opened, H5FD_mem_t kind, haddr_t at, std::string_view bytes) {
  std::string reason = "there is too little memory";
  try {
    if (kind == H5FD_MEM_SUPER) opened.guard->see_superblock(at, bytes);
    if (kind == H5FD_MEM_OHDR) opened.guard->judge(at, bytes, opened.end);
    return 0;
  } catch (const Unsound& unsound) {
    reason = unsound.reason;
  } catch (const std::bad_alloc&) {
  }
  H5Epush2(H5E_DEFAULT, __FILE__, "judge", __LINE__, H5E_ERR_CLS, H5E_IO, H5E_READERROR, "%s", reason.c_str());
  return -1;
}

herr_t read_all(H5FD_t* file, H5FD_mem_t kind, hid_t, haddr_t at, std::size_t count, void* buffer) {
  OpenFile& opened = ours(file);
  char* const to = static_cast<char*>(buffer);
  if (read_bytes(opened, at, count, to) < 0) return -1;
  return opened.guard ? judge(opened, kind, at, std::string_view(to, count)) : 0;
}

herr_t write_all(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t count, const void* buffer) {
  OpenFile& opened = ours(file);
  for (const char* from = static_cast<const char*>(buffer); count > 0;) {
    const ssize_t put = ::pwrite(opened.descriptor, from, count, static_cast<off_t>(at));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return fail("write", H5E_WRITEERROR);
    from += put;
    at += static_cast<haddr_t>(put);
    count -= static_cast<std::size_t>(put);
    opened.size = std::max(opened.size, at);
  }
  return 0;
}

/// The file becomes as long as what is used of it.
herr_t cut(H5FD_t* file, hid_t, hbool_t) {
  OpenFile& opened = ours(file);
  if (opened.size == opened.end) return 0;
  if (::ftruncate(opened.descriptor, static_cast<off_t>(opened.end)) != 0) return fail("ftruncate", H5E_SEEKERROR);
  opened.size = opened.end;
  return 0;
}

template <FileOf of>
H5FD_class_t description() {
  H5FD_class_t driver{};
  driver.name = of == FileOf::archive ? "modebank_archive" : "modebank";
  driver.maxaddr = static_cast<haddr_t>(std::numeric_limits<off_t>::max());
  driver.fc_degree = H5F_CLOSE_WEAK;
  driver.open = open_file_of_ours<of>;
  driver.close = close_file;
  driver.cmp = compare;
  driver.query = [](const H5FD_t* file, unsigned long* features) -> herr_t {
    constexpr unsigned long gathered =
        H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_AGGREGATE_SMALLDATA;
    if (features) *features = H5FD_FEAT_DATA_SIEVE | (file && ours(file).in_the_making ? gathered : 0);
    return 0;
  };
  driver.get_eoa = [](const H5FD_t* file, H5FD_mem_t) { return ours(file).end; };
  driver.set_eoa = [](H5FD_t* file, H5FD_mem_t, haddr_t end) -> herr_t {
    ours(file).end = end;
    return 0;
  };
  driver.get_eof = [](const H5FD_t* file, H5FD_mem_t) { return ours(file).size; };
  driver.get_handle = [](H5FD_t* file, hid_t, void** handle) -> herr_t {
    *handle = &ours(file);
    return 0;
  };
  driver.read = read_all;
  driver.write = write_all;
  driver.truncate = cut;
  constexpr H5FD_mem_t kinds[] = H5FD_FLMAP_SINGLE;
  for (int kind = 0; kind < H5FD_MEM_NTYPES; ++kind) driver.fl_map[kind] = kinds[kind];
  return driver;
}

}  // namespace

namespace {

template <FileOf of>
hid_t registered() {
  static const H5FD_class_t driver = description<of>();
  static const hid_t id = H5FDregister(&driver);
  return id;
}

}  // namespace

hid_t file_driver(FileOf of) {
  return of == FileOf::archive ? registered<FileOf::archive>() : registered<FileOf::anybody>();
}

OpenedFile opened_file(hid_t object) {
  const Handle file(H5Iget_file_id(object), H5Fclose, "find the file"),
      access(H5Fget_access_plist(file.id()), H5Pclose, "read how the file was opened"),
      creation(H5Fget_create_plist(file.id()), H5Pclose, "read how the file was made");
  const hid_t driver = H5Pget_driver(access.id());
  if (driver != file_driver() && driver != file_driver(FileOf::archive)) return {};
  OpenedFile opened;
  hsize_t before = 0;
  check(H5Fget_vfd_handle(file.id(), access.id(), &opened.handle), "find the file");
  check(H5Pget_userblock(creation.id(), &before), "read how the file was made");
  opened.before = before;
  return opened;
}

int descriptor_of(void* handle) { return static_cast<OpenFile*>(handle)->descriptor; }
bool is_in_the_making(void* handle) { return static_cast<OpenFile*>(handle)->in_the_making; }
haddr_t end_of(void* handle) { return static_cast<OpenFile*>(handle)->end; }

void append(void* handle, std::string_view bytes) {
  OpenFile& file = *static_cast<OpenFile*>(handle);
  check(write_all(&file.known, H5FD_MEM_OHDR, H5P_DEFAULT, file.end, bytes.size(), bytes.data()), "write the archive");
  file.end += bytes.size();
}

}  // namespace modebank::hdf5
