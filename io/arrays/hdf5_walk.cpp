#include "io/arrays/hdf5_walk.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "io/arrays/hdf5_objects.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

using hdf5::Handle;
using hdf5::Shape;

void Hdf5Walk::group(hid_t id, const std::string& path, const std::string& name, int depth) {
  if (depth > deepest_group || !seen_.insert(hdf5_address(id)).second) return;
  if (!hdf5_text_attribute(id, "pandas_type").empty())
    return left_out.push_back(
        fmt::format("{0} is a frame of pandas, which is not read: python3 -c \"import pandas; pandas.read_hdf('{1}', "
                    "'{2}').to_csv('{0}.csv')\"",
                    name, file, path));
  if (const std::string made = hdf5_text_attribute(id, "MATLAB_class"); is_object(id, made))
    return note_object(made, name);
  if (hdf5::has_attribute(id, "OCTAVE_NEW_FORMAT") && hdf5::has_link(id, "value"))
    return left_out.push_back(fmt::format(
        "{0} is a variable of Octave's -hdf5, which is not read: octave --eval \"s = load('{1}'); save('-v7', "
        "'{1}.mat', '-struct', 's')\"",
        name, file));
  for (const std::string& member : hdf5::member_names(id)) {
    if (member.starts_with("#")) continue;  // MATLAB's folder for values that are used by reference
    if (columns.size() > most_objects)
      throw DataError(fmt::format("more than {} columns, which is too many for a log", most_objects));
    link(id, member, path + "/" + member, name, depth);
  }
}

void Hdf5Walk::turn_matrices() {
  std::set<std::uint64_t> lengths;
  for (const StoredColumn& column : columns) lengths.insert(column.rows);
  for (const Matrix& matrix : matrices_) {
    hsize_t along = matrix.habit;
    if (!lengths.contains(matrix.shape[along]) && lengths.contains(matrix.shape[1 - along])) along = 1 - along;
    if (!lengths.contains(matrix.shape[along]) && matrix.shape[1 - along] > 10 * matrix.shape[along]) {
      note_array(matrix.column.path(), matrix.object);
      continue;
    }
    const hsize_t wide = std::min<hsize_t>(matrix.shape[1 - along], most_columns);
    for (hsize_t j = 0; j < wide; ++j) {
      StoredColumn column = matrix.column;
      column.name += fmt::format("[{}]", j);
      column.rows = matrix.shape[along];
      add(std::move(column), {matrix.object, {}, j, along});
    }
  }
}

void Hdf5Walk::add(StoredColumn column, Hdf5Place place) {
  columns.push_back(std::move(column));
  places.push_back(std::move(place));
}

bool Hdf5Walk::is_object(hid_t id, const std::string& made) {
  return hdf5::has_attribute(id, "MATLAB_object_decode") || !matlab_conversion(made, "x").empty();
}

void Hdf5Walk::note_object(const std::string& made, const std::string& name) {
  left_out.push_back(matlab_object(made, name, made == "iddata" ? "" : file));
}

void Hdf5Walk::note_array(const std::string& name, const std::string& path) {
  left_out.push_back(not_a_table(name, fmt::format("import h5py; f = h5py.File('{}'); a = f['{}'][()]", file, path),
                                 "[f[r][()] for r in a.flat]"));
}

void Hdf5Walk::note_foreign(const std::string& path) {
  left_out.push_back(path + " lies in another file, which is not followed");
}

void Hdf5Walk::link(hid_t parent, const std::string& member, const std::string& path, const std::string& group_name,
                    int depth) {
  H5L_info_t info{};
  hdf5::check(H5Lget_info(parent, member.c_str(), &info, H5P_DEFAULT), "look at the link '" + path + "'");
  if (info.type == H5L_TYPE_EXTERNAL) note_foreign(path);
  if (info.type != H5L_TYPE_HARD) return;
  const Handle object(H5Oopen(parent, member.c_str(), H5P_DEFAULT), H5Oclose, "open '" + path + "'");
  const std::string name = group_name.empty() ? member : group_name + "." + member;
  const H5I_type_t kind = H5Iget_type(object.id());
  if (kind == H5I_GROUP) group(object.id(), path, name, depth + 1);
  if (kind == H5I_DATASET) dataset(object.id(), path, group_name, member, depth);
}

void Hdf5Walk::dataset(hid_t id, const std::string& path, const std::string& group_name, const std::string& name,
                       int depth) {
  const std::string made = hdf5_text_attribute(id, "MATLAB_class");
  const std::string full = group_name.empty() ? name : group_name + "." + name;
  if (is_object(id, made)) return note_object(made, full);
  if (hdf5_lies_outside(id)) return note_foreign(path);
  const Handle type(H5Dget_type(id), H5Tclose, "read the type of '" + path + "'");
  const Shape shape = hdf5_shape(id);
  if (made == "char") return;
  if (H5Tget_class(type.id()) == H5T_REFERENCE && made.empty() && depth > 0 && depth < deepest_group)
    return struct_array(id, type.id(), shape, group_name, name, depth);
  if (made == "cell") return note_array(full, path);
  if (!made.empty() && made != "logical" && !hdf5_is_number(type.id())) return;
  StoredColumn column{group_name, name, hdf5_type_name(type.id()), hdf5_unit(id)};
  column.text = hdf5_is_text(type.id());
  column.scale = hdf5_number_attribute(id, "scale_factor", column.scale);
  column.offset = hdf5_number_attribute(id, "add_offset", column.offset);
  column.fill = hdf5_number_attribute(id, "_FillValue", column.fill);
  const bool packed = column.scale != 1.0 || column.offset != 0.0 || !std::isnan(column.fill);
  if (packed) left_out.push_back(full + " is read by its scale_factor, add_offset and _FillValue");
  column.whole = hdf5_is_whole(type.id()) && !packed;
  const bool table = H5Tget_class(type.id()) == H5T_COMPOUND;
  if (!table && !column.text && !hdf5_is_number(type.id())) return;
  if (hdf5::element_count(shape) > 1 &&
      H5Dget_storage_size(id) == 0) {  // no value was written, because HDF5 allocates at the first write
    unwritten[full] = fmt::format("its {} values were never written", hdf5::element_count(shape));
    return left_out.push_back(fmt::format("{} is left out: {}", full, unwritten[full]));
  }
  if (table) return compound(type.id(), shape, {path, {}, 0, 0}, full);
  plain(std::move(column), path, shape, made.empty() ? 0 : 1);
}

void Hdf5Walk::plain(StoredColumn column, const std::string& path, const Shape& shape, hsize_t habit) {
  if (column.name == "Ts" && !column.text && hdf5::element_count(shape) == 1)
    sample_times[column.group] = {path, {}, 0, 0};
  if (shape.size() == 1 && shape[0] > 1) {
    column.rows = shape[0];
    return add(std::move(column), {path, {}, 0, 0});
  }
  if (shape.size() > 2 && hdf5::element_count(shape) > 1) return note_array(column.path(), path);
  if (shape.size() != 2 || shape[0] * shape[1] <= 1 || (column.text && shape[1] != 1)) return;
  if (shape[0] > 1 && shape[1] > 1) return matrices_.push_back({std::move(column), path, shape, habit});
  const hsize_t along = shape[0] > 1 ? 0 : 1;
  column.rows = shape[along];
  add(std::move(column), {path, {}, 0, along});
}

void Hdf5Walk::compound(hid_t type, const Shape& shape, const Hdf5Place& place, const std::string& group_name) {
  if (shape.size() != 1 || shape[0] < 2) return;
  if (place.member.empty()) ++tables;
  for (int i = 0; i < H5Tget_nmembers(type); ++i) {
    Hdf5Place inner = place;
    inner.member.push_back(hdf5_member_name(type, static_cast<unsigned>(i)));
    const Handle part(H5Tget_member_type(type, static_cast<unsigned>(i)), H5Tclose, "read a member's type");
    if (H5Tget_class(part.id()) == H5T_COMPOUND)
      compound(part.id(), shape, inner, group_name);
    else
      member(part.id(), shape[0], inner, group_name);
  }
}

void Hdf5Walk::member(hid_t type, hsize_t rows, const Hdf5Place& place, const std::string& group_name) {
  const bool array = H5Tget_class(type) == H5T_ARRAY;
  const Handle part(array ? H5Tget_super(type) : H5Tcopy(type), H5Tclose, "read a member's type");
  const hsize_t elements = array ? hdf5_array_elements(type) : 1;
  if (!hdf5_is_number(part.id()) && !(hdf5_is_text(part.id()) && elements == 1)) return;
  for (hsize_t e = 0; e < std::min<hsize_t>(elements, most_columns); ++e) {
    StoredColumn column{group_name, fmt::format("{}", fmt::join(place.member, ".")), hdf5_type_name(part.id()), "",
                        rows};
    if (array) column.name += fmt::format("[{}]", e);
    column.text = hdf5_is_text(part.id());
    column.whole = hdf5_is_whole(part.id());
    add(std::move(column), {place.object, place.member, e, 0});
  }
}

void Hdf5Walk::struct_array(hid_t id, hid_t type, const Shape& shape, const std::string& group_name,
                            const std::string& name, int depth) {
  const hsize_t count = hdf5::element_count(shape);
  if (H5Tequal(type, H5T_STD_REF_OBJ) <= 0 || count == 0 || count > most_columns) return;
  std::vector<hobj_ref_t> references(static_cast<std::size_t>(count));
  hdf5_read(id, H5T_STD_REF_OBJ, H5S_ALL, H5S_ALL, references.data());
  for (std::size_t i = 0; i < references.size(); ++i) {
    const Handle object(H5Rdereference2(id, H5P_DEFAULT, H5R_OBJECT, &references[i]), H5Oclose,
                        "follow a reference of '" + name + "'");
    const std::string path = hdf5_path(object.id()), holder = fmt::format("{}[{}]", group_name, i);
    if (H5Iget_type(object.id()) == H5I_DATASET) dataset(object.id(), path, holder, name, deepest_group);
    if (H5Iget_type(object.id()) == H5I_GROUP) group(object.id(), path, holder + "." + name, depth + 1);
  }
}

}  // namespace modebank
