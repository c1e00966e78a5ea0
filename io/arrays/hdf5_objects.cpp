#include "io/arrays/hdf5_objects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

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

double hdf5_number_attribute(hid_t object, const std::string& name, double otherwise) {
  if (!hdf5::has_attribute(object, name)) return otherwise;
  const hdf5::StoredArray attribute(object, hdf5::Place::attribute, name);
  if (attribute.elements() == 1 && hdf5_is_number(attribute.type())) attribute.read(H5T_NATIVE_DOUBLE, &otherwise);
  return otherwise;
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

Handle hdf5_open_log(const std::string& path) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file >= 0) return {file, H5Fclose, "open the file"};
  // A logger in SWMR mode (single writer, multiple readers) is still writing the file, or it was killed while writing.
  const hid_t written = H5Fopen(path.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, H5P_DEFAULT);
  return written >= 0 ? Handle(written, H5Fclose, "open the file") : hdf5::open_file(path);
}

bool hdf5_lies_outside(hid_t dataset) {
  const Handle made(H5Dget_create_plist(dataset), H5Pclose, "look at a dataset");
  return H5Pget_layout(made.id()) == H5D_VIRTUAL || H5Pget_external_count(made.id()) > 0;
}

namespace {

/// Names a dataset's filter that is not installed. Adds a line of Python that copies the file without this filter.
/// Empty if all filters are installed.
std::string missing_filter(hid_t dataset) {
  constexpr H5Z_filter_t lzf = 32000;
  const Handle made(H5Dget_create_plist(dataset), H5Pclose, "look at a dataset");
  for (int i = 0; i < H5Pget_nfilters(made.id()); ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    std::string name(64, '\0');
    const H5Z_filter_t filter = H5Pget_filter2(made.id(), static_cast<unsigned>(i), &flags, &values, nullptr,
                                               name.size(), name.data(), &config);
    if (H5Zfilter_avail(filter) > 0) continue;
    name.resize(std::min(name.find('\0'), name.size()));
    std::string file(static_cast<std::size_t>(std::max<ssize_t>(H5Fget_name(dataset, nullptr, 0), 0)) + 1, '\0');
    H5Fget_name(dataset, file.data(), file.size());
    file.pop_back();
    return fmt::format(
        "filter {} ({}) is not installed; copy the file without it: python3 -c \"import h5py{}; a = h5py.File('{}'); b "
        "= h5py.File('{}', 'w'); a.visititems(lambda n, o: (b.create_dataset(n, data=o[()]) if isinstance(o, "
        "h5py.Dataset) else b.create_group(n)).attrs.update(o.attrs))\"{}",
        filter, name.empty() ? "no name" : name, filter == lzf ? "" : ", hdf5plugin", file,
        std::filesystem::path(file).replace_extension("plain.h5").string(),
        filter == lzf ? "" : " (Debian's h5py: import tables in place of hdf5plugin)");
  }
  return {};
}

}  // namespace

void hdf5_read(hid_t dataset, hid_t memory_type, hid_t memory_space, hid_t file_space, void* to) {
  if (H5Dread(dataset, memory_type, memory_space, file_space, H5P_DEFAULT, to) >= 0) return;
  if (const std::string missing = missing_filter(dataset); !missing.empty()) throw DataError(missing);
  hdf5::check(H5Dread(dataset, memory_type, memory_space, file_space, H5P_DEFAULT, to), "read its values");
}

std::vector<LineRange> hdf5_unwritten_lines(hid_t dataset, hsize_t along, hsize_t across) {
  const Handle made(H5Dget_create_plist(dataset), H5Pclose, "look at a dataset");
  const Shape shape = hdf5_shape(dataset);
  if (H5Pget_layout(made.id()) != H5D_CHUNKED) return {};
  Shape chunk(shape.size()), offset(shape.size());
  H5Pget_chunk(made.id(), static_cast<int>(chunk.size()), chunk.data());
  hsize_t all = 1, written = 0;
  for (std::size_t d = 0; d < shape.size(); ++d) all *= (shape[d] + chunk[d] - 1) / chunk[d];
  const Handle space(H5Dget_space(dataset), H5Sclose, "read a shape");
  hdf5::check(H5Dget_num_chunks(dataset, space.id(), &written), "count its chunks");
  std::vector<LineRange> ranges;
  if (written >= all) return ranges;
  if (shape.size() == 2) offset[1 - along] = across / chunk[1 - along] * chunk[1 - along];
  for (hsize_t row = 0; row < shape[along]; row += chunk[along]) {
    offset[along] = row;
    unsigned mask = 0;
    haddr_t address = HADDR_UNDEF;
    hsize_t bytes = 0;
    hdf5::check(H5Dget_chunk_info_by_coord(dataset, offset.data(), &mask, &address, &bytes), "look for a chunk");
    if (address != HADDR_UNDEF) continue;
    const LineRange missing{row + 1, std::min(row + chunk[along], shape[along])};
    if (!ranges.empty() && ranges.back().last + 1 == missing.first)
      ranges.back().last = missing.last;
    else
      ranges.push_back(missing);
  }
  return ranges;
}

Handle hdf5_member_type(hid_t compound, const std::vector<std::string>& member) {
  Handle type(H5Tcopy(compound), H5Tclose, "read a table's type");
  for (const std::string& name : member) {
    const int position = H5Tget_member_index(type.id(), name.c_str());
    hdf5::check(position, "find the member");
    type = Handle(H5Tget_member_type(type.id(), static_cast<unsigned>(position)), H5Tclose, "read a member's type");
  }
  return type;
}

Handle hdf5_only_member(const std::vector<std::string>& member, Handle cell) {
  for (auto name = member.rbegin(); name != member.rend(); ++name) {
    Handle row(H5Tcreate(H5T_COMPOUND, H5Tget_size(cell.id())), H5Tclose, "make a type");
    hdf5::check(H5Tinsert(row.id(), name->c_str(), 0, cell.id()), "make a type");
    cell = std::move(row);
  }
  return cell;
}

namespace {

std::string without_padding(std::string text) {
  text.resize(std::min(text.find('\0'), text.size()));
  const std::size_t last = text.find_last_not_of(' ');
  text.resize(last == std::string::npos ? 0 : last + 1);
  return text;
}

}  // namespace

std::vector<std::string> hdf5_read_texts(hid_t dataset, const std::vector<std::string>& member) {
  const auto rows = static_cast<std::size_t>(hdf5::element_count(hdf5_shape(dataset)));
  const Handle whole(H5Dget_type(dataset), H5Tclose, "read a type");
  const Handle type = hdf5_member_type(whole.id(), member);
  const std::size_t bytes = H5Tget_size(type.id());
  const Handle memory = hdf5_only_member(member, Handle(H5Tcopy(type.id()), H5Tclose, "make a type"));
  std::string cells(rows * bytes, '\0');
  hdf5_read(dataset, memory.id(), H5S_ALL, H5S_ALL, cells.data());
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
