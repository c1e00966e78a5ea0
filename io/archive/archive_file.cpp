#include "io/archive/archive_file.hpp"

#include <atomic>
#include <fstream>

#include "io/archive/bank/open_archive.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

constexpr std::size_t growth_bytes = std::size_t{4} << 20;  ///< memory is extended in steps of this size

hdf5::Handle file_access() {
  hdf5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "prepare the archive");
  // The 1.8 format has checksums on all metadata. Every HDF5 library since 2008 reads this format, also in MATLAB and
  // Octave.
  hdf5::check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18), "choose the file format");
  return access;
}

hdf5::Handle memory_access() {
  hdf5::Handle access = file_access();
  hdf5::check(H5Pset_fapl_core(access.id(), growth_bytes, false), "prepare the archive in memory");
  return access;
}

hdf5::Handle create_file(const std::string& name, const hdf5::Handle& access) {
  const hdf5::Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "prepare the archive");
  hdf5::check(H5Pset_userblock(creation.id(), user_block_bytes), "reserve the user block");
  hdf5::check(H5Pset_obj_track_times(creation.id(), false), "prepare the archive");
  return {H5Fcreate(name.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose, "create the archive"};
}

/// HDF5 identifies files in memory by name too, so each one needs a different name.
std::string image_name() {
  static std::atomic<unsigned> count{0};
  return "modebank " + std::to_string(count++);
}

}  // namespace

ArchiveImage::ArchiveImage() : access_(memory_access()), file_(create_file(image_name(), access_)) {}

hdf5::Handle create_archive_file(const std::filesystem::path& path) {
  return create_file(path.string(), file_access());
}

std::string_view ArchiveImage::content() const {
  hdf5::check(H5Fflush(file_.id(), H5F_SCOPE_GLOBAL), "complete the archive");
  const ssize_t bytes = H5Fget_file_image(file_.id(), nullptr, 0);  // size of the content, without the user block
  hdf5::check(bytes < 0 ? -1 : 0, "measure the archive");
  void* memory = nullptr;
  hdf5::check(H5Fget_vfd_handle(file_.id(), access_.id(), &memory), "find the archive in memory");
  const unsigned char* begin = *static_cast<unsigned char**>(memory) + user_block_bytes;
  return {reinterpret_cast<const char*>(begin), static_cast<std::size_t>(bytes)};
}

void stamp_hash(const std::filesystem::path& path) {
  const UserBlock block = make_user_block(content_hash(path));
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.write(block.data(), block.size());
  file.close();
  if (!file) throw DataError("the hash could not be written");
}

}  // namespace modebank
