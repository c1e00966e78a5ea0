#include "io/arrays/hdf5_walk.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "io/arrays/hdf5_objects.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

using hdf5::Handle;
using hdf5::Shape;

void Hdf5Walk::group(hid_t id, const std::string& path, const std::string& name, int depth) {
  if (depth > deepest_group || !seen_.insert(hdf5_address(id)).second) return;
  const std::string pandas = hdf5_text_attribute(id, "pandas_type");
  if (pandas == "frame" || pandas == "series") return fixed_frame(id, path, name);
  if (pandas.ends_with("_table")) return table_frame(id, path, name);
  if (const std::string made = hdf5_text_attribute(id, "MATLAB_class"); is_object(id, made))
    return note_object(made, name);
  if (hdf5::has_attribute(id, "OCTAVE_NEW_FORMAT") && hdf5::has_link(id, "value"))
    return octave_variable(id, path, name, depth);
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

void Hdf5Walk::note_foreign(const std::string& path) {
  left_out.push_back(path + " lies in another file, which is not followed");
}

void Hdf5Walk::octave_variable(hid_t id, const std::string& path, const std::string& name, int depth) {
  const Handle value(H5Oopen(id, "value", H5P_DEFAULT), H5Oclose, "open '" + path + "/value'");
  if (H5Iget_type(value.id()) == H5I_GROUP) return group(value.id(), path + "/value", name, depth + 1);
  const std::size_t dot = name.rfind('.'), last = dot == std::string::npos ? 0 : dot + 1;
  dataset(value.id(), path + "/value", name.substr(0, last == 0 ? 0 : dot), name.substr(last) + ".value", depth);
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
  if (made == "char") return note_label(id, full, shape);
  if (H5Tget_class(type.id()) == H5T_REFERENCE && made.empty() && depth > 0 && depth < deepest_group)
    return struct_array(id, type.id(), shape, group_name, name, depth);
  if (!made.empty() && made != "logical" && !hdf5_is_number(type.id())) return;
  StoredColumn column{group_name, name, hdf5_type_name(type.id()), hdf5_unit(id)};
  column.text = hdf5_is_text(type.id());
  column.whole = hdf5_is_whole(type.id());
  const bool table = H5Tget_class(type.id()) == H5T_COMPOUND;
  if (!table && !column.text && !hdf5_is_number(type.id())) return;
  if (hdf5::element_count(shape) > 1 &&
      H5Dget_storage_size(id) == 0) {  // no value was written, because HDF5 allocates at the first write
    unwritten[full] = fmt::format("its {} values were never written", hdf5::element_count(shape));
    return left_out.push_back(fmt::format("{} is left out: {}", full, unwritten[full]));
  }
  if (table) return compound(type.id(), shape, {path, {}, 0, 0}, full, {});
  plain(std::move(column), path, shape, made.empty() ? 0 : 1);
}

void Hdf5Walk::plain(StoredColumn column, const std::string& path, const Shape& shape, hsize_t habit) {
  if (column.name == "Ts" && !column.text && hdf5::element_count(shape) == 1)
    sample_times[column.group] = {path, {}, 0, 0};
  if (shape.size() == 1 && shape[0] > 1) {
    column.rows = shape[0];
    return add(std::move(column), {path, {}, 0, 0});
  }
  if (shape.size() != 2 || shape[0] * shape[1] <= 1 || (column.text && shape[1] != 1)) return;
  if (shape[0] > 1 && shape[1] > 1) return matrices_.push_back({std::move(column), path, shape, habit});
  const hsize_t along = shape[0] > 1 ? 0 : 1;
  column.rows = shape[along];
  add(std::move(column), {path, {}, 0, along});
}

void Hdf5Walk::compound(hid_t type, const Shape& shape, const Hdf5Place& place, const std::string& group_name,
                        const std::map<std::string, std::vector<std::string>>& names) {
  if (shape.size() != 1 || shape[0] < 2) return;
  if (place.member.empty()) ++tables;
  for (int i = 0; i < H5Tget_nmembers(type); ++i) {
    Hdf5Place inner = place;
    inner.member.push_back(hdf5_member_name(type, static_cast<unsigned>(i)));
    const Handle part(H5Tget_member_type(type, static_cast<unsigned>(i)), H5Tclose, "read a member's type");
    const auto known = names.find(inner.member.back());
    if (H5Tget_class(part.id()) == H5T_COMPOUND)
      compound(part.id(), shape, inner, group_name, {});
    else
      member(part.id(), shape[0], inner, group_name, known == names.end() ? std::vector<std::string>() : known->second);
  }
}

void Hdf5Walk::member(hid_t type, hsize_t rows, const Hdf5Place& place, const std::string& group_name,
                      const std::vector<std::string>& names) {
  const bool array = H5Tget_class(type) == H5T_ARRAY;
  const Handle part(array ? H5Tget_super(type) : H5Tcopy(type), H5Tclose, "read a member's type");
  const hsize_t elements = array ? hdf5_array_elements(type) : 1;
  if (!hdf5_is_number(part.id()) && !(hdf5_is_text(part.id()) && elements == 1)) return;
  for (hsize_t e = 0; e < std::min<hsize_t>(elements, most_columns); ++e) {
    StoredColumn column{group_name, fmt::format("{}", fmt::join(place.member, ".")), hdf5_type_name(part.id()), "",
                        rows};
    if (e < names.size())
      column.name = names[e];
    else if (array)
      column.name += fmt::format("[{}]", e);
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

void Hdf5Walk::note_label(hid_t id, const std::string& full, const Shape& shape) {
  constexpr hsize_t longest = 200;
  const hsize_t count = hdf5::element_count(shape);
  if (!full.ends_with(".label") || count > longest) return;
  std::vector<std::uint64_t> letters(static_cast<std::size_t>(count));
  hdf5_read(id, H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, letters.data());
  std::string& label = labels[full];
  for (const std::uint64_t letter : letters)
    if (letter >= 32) label += letter < 127 ? static_cast<char>(letter) : '_';
}

void Hdf5Walk::fixed_frame(hid_t id, const std::string& path, const std::string& name) {
  ++tables;
  const auto add_index = [&](const std::string& axis) {
    const Handle data(H5Dopen2(id, axis.c_str(), H5P_DEFAULT), H5Dclose, "open the index of '" + path + "'");
    const Handle type(H5Dget_type(data.id()), H5Tclose, "read the type of an index");
    const bool dated = hdf5_text_attribute(data.id(), "kind").starts_with("datetime64");
    const std::string given = hdf5_text_attribute(data.id(), "name");
    StoredColumn column{name, given.empty() || given == "N." ? "index" : given,
                        dated ? "datetime64[ns]" : hdf5_type_name(type.id()), ""};
    column.whole = hdf5_is_whole(type.id());
    if (hdf5_is_number(type.id())) plain(std::move(column), path + "/" + axis, hdf5_shape(data.id()), 0);
  };
  if (hdf5::has_link(id, "axis1")) add_index("axis1");
  if (hdf5::has_link(id, "index")) add_index("index");
  if (hdf5::has_link(id, "values")) link(id, "values", path + "/values", name, 0);
  for (int block = 0; hdf5::has_link(id, fmt::format("block{}_values", block)); ++block)
    fixed_block(id, path, name, block);
}

void Hdf5Walk::fixed_block(hid_t id, const std::string& path, const std::string& name, int block) {
  const std::string member = fmt::format("block{}_values", block);
  const Handle data(H5Dopen2(id, member.c_str(), H5P_DEFAULT), H5Dclose, "open '" + member + "'");
  const Handle type(H5Dget_type(data.id()), H5Tclose, "read the type of '" + member + "'");
  const Shape shape = hdf5_shape(data.id());
  if (!hdf5_is_number(type.id()) || shape.size() != 2 || shape[0] < 2) return;  // a pickle; it may contain texts
  const Handle names(H5Dopen2(id, fmt::format("block{}_items", block).c_str(), H5P_DEFAULT), H5Dclose,
                     "open the items");
  const std::vector<std::string> items = hdf5_read_texts(names.id());
  for (hsize_t j = 0; j < std::min<hsize_t>(shape[1], items.size()); ++j) {
    StoredColumn column{name, items[static_cast<std::size_t>(j)], hdf5_type_name(type.id()), "", shape[0]};
    column.whole = hdf5_is_whole(type.id());
    add(std::move(column), {path + "/" + member, {}, j, 0});
  }
}

void Hdf5Walk::table_frame(hid_t id, const std::string& path, const std::string& name) {
  const Handle data(H5Dopen2(id, "table", H5P_DEFAULT), H5Dclose, "open the table of '" + path + "'");
  const Handle type(H5Dget_type(data.id()), H5Tclose, "read the type of a table");
  if (H5Tget_class(type.id()) != H5T_COMPOUND) return;
  std::map<std::string, std::vector<std::string>> names;
  for (int i = 0; i < H5Tget_nmembers(type.id()); ++i) {
    const std::string member = hdf5_member_name(type.id(), static_cast<unsigned>(i));
    names[member] = pickled_names(hdf5_text_attribute(data.id(), member + "_kind"));
  }
  const std::size_t first = columns.size();
  compound(type.id(), hdf5_shape(data.id()), {path + "/table", {}, 0, 0}, name, names);
  const bool dated = hdf5_text_attribute(data.id(), "index_kind").starts_with("datetime64");
  for (std::size_t i = first; i < columns.size(); ++i)
    if (dated && columns[i].name == "index") columns[i].type = "datetime64[ns]";
}

}  // namespace modebank
