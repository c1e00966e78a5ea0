#include "io/archive_file.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <system_error>

#include "ident/error.hpp"
#include "io/hdf5_array.hpp"
#include "io/user_block.hpp"

namespace modebank {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view hdf5_signature = "\x89HDF\r\n\x1a\n";

std::string bytes_at(const fs::path& path, std::streamoff offset, std::size_t count) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw DataError(std::generic_category().message(errno));
  std::string bytes(count, '\0');
  file.seekg(offset);
  file.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

/// Before HDF5 sees the file: most foreign files are told apart here.
void check_signature(const fs::path& path) {
  if (fs::file_size(path) == 0) throw DataError("the file is empty");
  if (bytes_at(path, user_block_bytes, hdf5_signature.size()) == hdf5_signature) return;
  if (bytes_at(path, 0, hdf5_signature.size()) == hdf5_signature)
    throw DataError("not a modebank archive (an HDF5 file of another program)");
  throw DataError("not a modebank archive");
}

std::string root_text(const hdf5::Handle& root, const std::string& name) {
  if (!hdf5::has_attribute(root.id(), name)) return {};
  const hdf5::StoredArray attribute(root.id(), hdf5::Place::attribute, name);
  return attribute.elements() == 1 ? attribute.texts().front() : std::string();
}

/// The number before the first dot; -1 when there is none.
int major_version(const std::string& version) {
  int major = -1;
  const auto [end, error] = std::from_chars(version.data(), version.data() + version.size(), major);
  const bool complete = error == std::errc() && (end == version.data() + version.size() || *end == '.');
  return complete && major >= 0 ? major : -1;
}

void check_schema(const hdf5::Handle& root) {
  if (root_text(root, "format") != archive_format)
    throw DataError("not a modebank archive (root attribute format is '" + root_text(root, "format") + "')");
  const std::string version = root_text(root, "schema_version");
  const int major = major_version(version);
  if (major < 0) throw DataError("schema_version '" + version + "' is not a version");
  if (major > major_version(schema_version))
    throw DataError("the archive's schema " + version + " is newer than " + schema_version +
                    ", which this version of modebank reads");
}

}  // namespace

void require_readable(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) throw ConfigurationError(path.string() + ": no such file");
  if (fs::is_directory(status)) throw DataError(path.string() + ": is a folder, not an archive");
  if (!fs::is_regular_file(status)) throw DataError(path.string() + ": is not a regular file");
}

hdf5::Handle open_archive(const fs::path& path) {
  require_readable(path);
  try {
    check_signature(path);
    hdf5::Handle file = hdf5::open_file(path.string());
    check_schema(open_root(file));
    return file;
  } catch (const DataError& error) {
    throw DataError(path.string() + ": " + error.what());
  } catch (const fs::filesystem_error& error) {
    throw DataError(path.string() + ": " + error.code().message());
  }
}

hdf5::Handle open_root(const hdf5::Handle& file) { return hdf5::open_group(file.id(), "/"); }

namespace {

constexpr std::size_t growth_bytes = std::size_t{4} << 20;  ///< memory is taken in steps of this

hdf5::Handle file_access() {
  hdf5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "prepare the archive");
  // The 1.8 format has checksums on all metadata and is read by every HDF5 since 2008, MATLAB's and Octave's included.
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

}  // namespace

ArchiveImage::ArchiveImage() : access_(memory_access()), file_(create_file("modebank", access_)) {}

hdf5::Handle create_archive_file(const fs::path& path) { return create_file(path.string(), file_access()); }

std::string_view ArchiveImage::content() const {
  hdf5::check(H5Fflush(file_.id(), H5F_SCOPE_GLOBAL), "complete the archive");
  const ssize_t bytes = H5Fget_file_image(file_.id(), nullptr, 0);  // of the content alone, without the user block
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
