#include "io/archive/groups/group_writer.hpp"

#include <algorithm>
#include <stdexcept>

namespace modebank {

namespace {

hdf5::Handle utf8_links() {
  hdf5::Handle link(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "prepare links");
  hdf5::check(H5Pset_char_encoding(link.id(), H5T_CSET_UTF8), "prepare links");
  return link;
}

}  // namespace

hdf5::Handle GroupWriter::make_group(const std::string& name) {
  if (hdf5::has_link(group_.id(), name)) return hdf5::open_group(group_.id(), name);
  const hdf5::Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "prepare groups");
  hdf5::check(H5Pset_obj_track_times(creation.id(), false), "prepare groups");
  return {H5Gcreate2(group_.id(), name.c_str(), utf8_links().id(), creation.id(), H5P_DEFAULT), H5Gclose,
          "create the group '" + name + "'"};
}

hdf5::Handle GroupWriter::rows_of(const std::string& name, hid_t file_type, const hdf5::Shape& shape) const {
  if (part_->first == 0) return hdf5::create_rows(group_.id(), name, file_type, shape);
  return {H5Dopen2(group_.id(), name.c_str(), H5P_DEFAULT), H5Dclose, "open '" + name + "'"};
}

void GroupWriter::write_text_rows(const std::string& name, const std::vector<std::string>& values) {
  const hdf5::Handle type = hdf5::array_text_type(part_->texts);
  hdf5::write_rows(rows_of(name, type.id(), {part_->total}), type.id(), {{part_->first, part_->count}},
                   hdf5::pack_texts(values, hdf5::longest(part_->texts)).data());
}

void agree(Sizes& sizes, const std::string& place, const Letters& letters, const hdf5::Shape& shape) {
  const std::string problem = sizes.agree(letters, shape);
  if (!problem.empty()) throw std::invalid_argument(place + " has " + problem);
}

hdf5::Shape shape_of(Sizes& sizes, const std::string& place, const Letters& letters, hsize_t rows, hsize_t cols,
                     bool is_vector, hsize_t all) {
  hdf5::Shape shape = is_vector ? hdf5::Shape{rows} : hdf5::Shape{cols, rows};
  if (letters.size() == 3) {
    const hsize_t second = sizes.find(letters[1]).value_or(0);
    const hsize_t third = sizes.find(letters[2]).value_or(second == 0 ? 0 : rows / second);
    if (second * third != rows)
      throw std::invalid_argument(place + " has " + std::to_string(rows) + " entries per column, must be " +
                                  std::to_string(second) + " x " + std::to_string(third));
    shape = {cols, second, third};
  }
  if (all > 0) shape.front() = all;
  agree(sizes, place, letters, shape);
  return shape;
}

namespace {

bool all_equal(const Unit& unit) {
  return std::all_of(unit.begin(), unit.end(), [&](const std::string& u) { return u == unit.front(); });
}

/// The trailing dimensions whose entries correspond to the units one by one, such as (p, p) of an (M, p, p) covariance.
/// Empty if no dimensions fit.
hdf5::Shape trailing_shape(const hdf5::Shape& shape, std::size_t count) {
  for (auto begin = shape.end(); begin != shape.begin();) {
    const hdf5::Shape tail(--begin, shape.end());
    if (hdf5::element_count(tail) == count) return tail;
  }
  return {};
}

}  // namespace

void write_unit(const hdf5::Handle& dataset, const Unit& unit, const hdf5::Shape& shape) {
  if (unit.empty() || (all_equal(unit) && unit.front().empty())) return;
  const auto write = [&](const std::vector<std::string>& texts, const hdf5::Shape& extents) {
    hdf5::write_texts(dataset.id(), hdf5::Place::attribute, "units", texts, extents);
  };
  if (all_equal(unit)) return write({unit.front()}, {});
  const hdf5::Shape tail = trailing_shape(shape, unit.size());
  if (!tail.empty()) write(unit, tail);
}

void GroupWriter::write_column_units(const hdf5::Handle& table, const std::vector<std::string>& units) {
  if (all_equal(units) && units.front().empty()) return;
  hdf5::write_texts(table.id(), hdf5::Place::attribute, "units", units, {units.size()});
}

}  // namespace modebank
