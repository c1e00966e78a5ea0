#include "io/arrays/hdf5_objects.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>

#include "io/arrays/stored_columns.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

using hdf5::Handle;
using hdf5::Shape;

haddr_t hdf5_address(hid_t object) {
  H5O_info_t info{};
  hdf5::check(H5Oget_info(object, &info), "look at an object");
  return info.addr;
}

std::string hdf5_path(hid_t object) {
  const ssize_t length = H5Iget_name(object, nullptr, 0);
  if (length <= 0) return {};
  std::string path(static_cast<std::size_t>(length) + 1, '\0');
  H5Iget_name(object, path.data(), path.size());
  path.pop_back();
  return path;
}

std::string hdf5_text_attribute(hid_t object, const std::string& name) {
  constexpr std::size_t longest = 1 << 16;
  if (!hdf5::has_attribute(object, name)) return {};
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, "open an attribute");
  const Handle type(H5Aget_type(attribute.id()), H5Tclose, "read an attribute's type");
  const Handle space(H5Aget_space(attribute.id()), H5Sclose, "read an attribute's shape");
  if (H5Tget_class(type.id()) != H5T_STRING || H5Sget_simple_extent_npoints(space.id()) != 1) return {};
  if (H5Tis_variable_str(type.id()) > 0) {
    char* text = nullptr;
    const Handle memory(H5Tcopy(type.id()), H5Tclose, "copy a type");
    hdf5::check(H5Aread(attribute.id(), memory.id(), &text), "read an attribute");
    std::string result = text ? text : "";
    H5free_memory(text);
    return result;
  }
  const std::size_t bytes = H5Tget_size(type.id());
  if (bytes > longest) return {};
  std::string text(bytes, '\0');
  hdf5::check(H5Aread(attribute.id(), type.id(), text.data()), "read an attribute");
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}

std::string hdf5_unit(hid_t object) {
  for (const char* name : {"units", "unit", "Units", "Unit"})
    if (std::string unit = hdf5_text_attribute(object, name); !unit.empty()) return unit;
  return {};
}

Shape hdf5_shape(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), H5Sclose, "read a shape");
  const int rank = H5Sget_simple_extent_ndims(space.id());
  Shape shape(static_cast<std::size_t>(std::max(rank, 0)));
  if (rank > 0) H5Sget_simple_extent_dims(space.id(), shape.data(), nullptr);
  return shape;
}

bool hdf5_is_number(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  return kind == H5T_INTEGER || kind == H5T_FLOAT || kind == H5T_ENUM || hdf5_is_bits(type);
}

bool hdf5_is_bits(hid_t type) {
  return H5Tget_class(type) == H5T_BITFIELD && H5Tget_size(type) <= sizeof(std::uint64_t);
}

bool hdf5_is_whole(hid_t type) { return H5Tget_class(type) == H5T_INTEGER || hdf5_is_bits(type); }

bool hdf5_is_text(hid_t type) { return H5Tget_class(type) == H5T_STRING; }

std::string hdf5_type_name(hid_t type) {
  const std::size_t bits = 8 * H5Tget_size(type);
  switch (H5Tget_class(type)) {
    case H5T_FLOAT:
      return bits == 64 ? "double" : fmt::format("float{}", bits);
    case H5T_INTEGER:
      return fmt::format("{}int{}", H5Tget_sign(type) == H5T_SGN_NONE ? "u" : "", bits);
    case H5T_ENUM:
      return "enumeration";
    case H5T_BITFIELD:
      return fmt::format("bits{}", bits);
    case H5T_STRING:
      return "text";
    default:
      return "";
  }
}

std::string hdf5_member_name(hid_t compound, unsigned member) {
  char* name = H5Tget_member_name(compound, member);
  std::string result = name ? name : "";
  H5free_memory(name);
  return result;
}

hsize_t hdf5_array_elements(hid_t array_type) {
  Shape shape(static_cast<std::size_t>(std::max(H5Tget_array_ndims(array_type), 0)));
  if (!shape.empty()) H5Tget_array_dims2(array_type, shape.data());
  return hdf5::element_count(shape);
}

namespace {

void check_filters(hid_t made) {
  for (int i = 0; i < H5Pget_nfilters(made); ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    std::string name(64, '\0');
    const H5Z_filter_t filter =
        H5Pget_filter2(made, static_cast<unsigned>(i), &flags, &values, nullptr, name.size(), name.data(), &config);
    if (filter <= H5Z_FILTER_SCALEOFFSET) continue;
    name.resize(std::min(name.find('\0'), name.size()));
    throw DataError(
        fmt::format("is compressed by filter {} ({}), which HDF5 does not bring: write it with zlib (gzip), or "
                    "`h5repack -f GZIP=5`",
                    filter, name.empty() ? "no name" : name));
  }
}

/// Bytes that zlib makes of `packed`, at most `most`.
std::size_t inflated_bytes(const std::string& packed, std::size_t most) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return 0;
  std::string piece(1 << 16, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));  // NOLINT: zlib only reads it
  stream.avail_in = static_cast<uInt>(packed.size());
  int status = Z_OK;
  while (status == Z_OK && stream.total_out < most) {
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    status = inflate(&stream, Z_NO_FLUSH);
  }
  inflateEnd(&stream);
  return stream.total_out;
}

/// HDF5 reads a chunk as long as it is declared, whatever its filters made of it.
void check_chunks(hid_t dataset, hid_t made, const Shape& chunk, hsize_t element_bytes) {
  const hsize_t declared = hdf5::element_count(chunk) * element_bytes;
  const int filters = H5Pget_nfilters(made);
  std::size_t values = 0;
  unsigned flags = 0, config = 0;
  const H5Z_filter_t last = filters == 0 ? 0
                                         : H5Pget_filter2(made, static_cast<unsigned>(filters - 1), &flags, &values,
                                                          nullptr, 0, nullptr, &config);
  const Handle space(H5Dget_space(dataset), H5Sclose, "read a shape");
  hsize_t count = 0, file_bytes = 0;
  const Handle file(H5Iget_file_id(dataset), H5Fclose, "look at the file");
  hdf5::check(H5Fget_filesize(file.id(), &file_bytes), "measure the file");
  hdf5::check(H5Dget_num_chunks(dataset, space.id(), &count), "count its chunks");
  for (hsize_t i = 0; i < count; ++i) {
    Shape offset(chunk.size());
    unsigned mask = 0;
    haddr_t at = 0;
    hsize_t stored = 0;
    hdf5::check(H5Dget_chunk_info(dataset, space.id(), i, offset.data(), &mask, &at, &stored), "look at a chunk");
    if (stored > file_bytes) throw DataError("declares chunks larger than the file");
    hsize_t unpacked = stored;
    if (mask == 0 && last == H5Z_FILTER_DEFLATE) {
      std::string packed(stored, '\0');
      unsigned unused = 0;
      hdf5::check(H5Dread_chunk(dataset, H5P_DEFAULT, offset.data(), &unused, packed.data()), "read a chunk");
      unpacked = inflated_bytes(packed, declared);
    } else if (mask == 0 && filters > 0) {
      continue;  // checksums and HDF5's own codes say their lengths
    }
    if (unpacked < declared) throw DataError("holds a chunk shorter than it declares");
  }
}

}  // namespace

namespace {

/// HDF5 copies members from where the type says that they are, inside it or not.
void check_members(hid_t type) {
  if (H5Tget_class(type) != H5T_COMPOUND) return;
  const std::size_t bytes = H5Tget_size(type);
  for (int i = 0; i < H5Tget_nmembers(type); ++i) {
    const auto member = static_cast<unsigned>(i);
    const Handle part(H5Tget_member_type(type, member), H5Tclose, "read a member's type");
    const std::size_t at = H5Tget_member_offset(type, member);
    if (at > bytes || H5Tget_size(part.id()) > bytes - at) throw DataError("has members that lie outside its rows");
    check_members(part.id());
  }
}

}  // namespace

void hdf5_check_readable(hid_t dataset) {
  constexpr std::uint64_t slack_bytes = 1 << 16, most_chunk_bytes = 1 << 30;
  if (hdf5::lies_outside(dataset)) throw DataError("lies outside the file, which is not followed");
  const Handle made(H5Dget_create_plist(dataset), H5Pclose, "look at a dataset");
  check_filters(made.id());
  const Handle type(H5Dget_type(dataset), H5Tclose, "read a type");
  check_members(type.id());
  const hsize_t elements = hdf5::element_count(hdf5_shape(dataset)),
                bytes = std::max<hsize_t>(H5Tget_size(type.id()), 1);
  const hsize_t stored = H5Dget_storage_size(dataset);
  // HDF5 copies compact content without looking at its size, and no filter unpacks any but chunks.
  const bool packed = H5Pget_layout(made.id()) == H5D_CHUNKED && H5Pget_nfilters(made.id()) > 0;
  const hsize_t most = packed ? (stored + slack_bytes) * most_expansion : stored;
  if (elements > most / bytes) throw DataError("declares more content than the file holds");
  if (H5Pget_layout(made.id()) != H5D_CHUNKED) return;
  Shape chunk(hdf5_shape(dataset).size());
  H5Pget_chunk(made.id(), static_cast<int>(chunk.size()), chunk.data());
  if (hdf5::element_count(chunk) > std::min<hsize_t>(most_chunk_bytes, (stored + slack_bytes) * most_expansion) / bytes)
    throw DataError("declares chunks larger than the file can fill");
  check_chunks(dataset, made.id(), chunk, bytes);
}

std::vector<std::string> pickled_names(const std::string& pickle) {
  std::vector<std::string> names;
  std::string_view rest = pickle;
  if (!rest.starts_with("(lp")) return {};
  const auto take_line = [&rest] {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    return line;
  };
  take_line();
  while (!rest.empty() && rest != "." && rest != "a.") {
    std::string_view line = take_line();
    if (line.starts_with("a")) line.remove_prefix(1);
    if (line.starts_with("p")) continue;  // where Python would keep a copy
    if (!line.starts_with("V") || line.find('\\') != std::string_view::npos) return {};
    names.emplace_back(line.substr(1));
  }
  return names;
}

namespace {

std::string without_padding(std::string text) {
  text.resize(std::min(text.find('\0'), text.size()));
  const std::size_t last = text.find_last_not_of(' ');
  text.resize(last == std::string::npos ? 0 : last + 1);
  return text;
}

}  // namespace

std::vector<std::string> hdf5_read_texts(hid_t dataset, const std::string& member) {
  const auto rows = static_cast<std::size_t>(hdf5::element_count(hdf5_shape(dataset)));
  const Handle whole(H5Dget_type(dataset), H5Tclose, "read a type");
  const int position = member.empty() ? 0 : H5Tget_member_index(whole.id(), member.c_str());
  hdf5::check(position, "find the member");
  const Handle type(
      member.empty() ? H5Tcopy(whole.id()) : H5Tget_member_type(whole.id(), static_cast<unsigned>(position)), H5Tclose,
      "read a type");
  const std::size_t bytes = H5Tget_size(type.id());
  const Handle memory(member.empty() ? H5Tcopy(type.id()) : H5Tcreate(H5T_COMPOUND, bytes), H5Tclose, "make a type");
  if (!member.empty()) hdf5::check(H5Tinsert(memory.id(), member.c_str(), 0, type.id()), "make a type");
  std::string cells(rows * bytes, '\0');
  hdf5::check(H5Dread(dataset, memory.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, cells.data()), "read its texts");
  std::vector<std::string> texts(rows);
  const bool variable = H5Tis_variable_str(type.id()) > 0;
  for (std::size_t k = 0; k < rows; ++k) {
    if (!variable) texts[k] = without_padding(cells.substr(k * bytes, bytes));
    if (variable)
      if (const char* text = reinterpret_cast<char* const*>(cells.data())[k]) texts[k] = without_padding(text);
  }
  if (variable) {
    const Handle space(H5Dget_space(dataset), H5Sclose, "read a shape");
    H5Dvlen_reclaim(memory.id(), space.id(), H5P_DEFAULT, cells.data());
  }
  return texts;
}

}  // namespace modebank
