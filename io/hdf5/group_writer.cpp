#include "io/hdf5/group_writer.hpp"

#include <algorithm>
#include <stdexcept>

namespace modebank {

hdf5::Handle GroupWriter::make_group(const std::string& name) {
  if (goes_on_ && hdf5::has_link(group_.id(), name)) return hdf5::open_group(group_.id(), name);
  return hdf5::make_group(group_.id(), name);
}

void GroupWriter::write_text_rows(const std::string& name, const std::vector<std::string>& values) {
  const hdf5::Handle type = hdf5::array_text_type(part_->texts);
  hdf5::write_rows(group_.id(), name, type.id(), type.id(), {part_->total}, part_->first, part_->count,
                   hdf5::pack_texts(values, hdf5::longest(part_->texts)).data());
}

void GroupWriter::agree(const std::string& name, const Letters& letters, const hdf5::Shape& shape) {
  const std::string problem = sizes_.agree(letters, shape);
  if (!problem.empty()) throw std::invalid_argument(path_ + "/" + name + " has " + problem);
}

hdf5::Shape GroupWriter::shape_of(const std::string& name, const Letters& letters, hsize_t rows, hsize_t cols,
                                  bool is_vector) {
  hdf5::Shape shape = is_vector ? hdf5::Shape{rows} : hdf5::Shape{cols, rows};
  if (letters.size() == 3) {
    const hsize_t second = sizes_.find(letters[1]).value_or(0);
    const hsize_t third = sizes_.find(letters[2]).value_or(second == 0 ? 0 : rows / second);
    if (second * third != rows)
      throw std::invalid_argument(path_ + "/" + name + " has " + std::to_string(rows) +
                                  " entries per column, must be " + std::to_string(second) + " x " +
                                  std::to_string(third));
    shape = {cols, second, third};
  }
  hdf5::Shape whole = shape;
  if (part_ && letters.front() == "M") whole.front() = part_->total;
  agree(name, letters, whole);
  return shape;
}

namespace {

bool all_equal(const Unit& unit) {
  return std::all_of(unit.begin(), unit.end(), [&](const std::string& u) { return u == unit.front(); });
}

/// The trailing dimensions that hold one unit each, e.g. (p, p) of an (M, p, p) covariance; empty when none fits.
hdf5::Shape trailing_shape(const hdf5::Shape& shape, std::size_t count) {
  for (auto begin = shape.end(); begin != shape.begin();) {
    const hdf5::Shape tail(--begin, shape.end());
    if (hdf5::element_count(tail) == count) return tail;
  }
  return {};
}

}  // namespace

hdf5::Handle GroupWriter::open_dataset(const std::string& name) const {
  return {H5Dopen2(group_.id(), name.c_str(), H5P_DEFAULT), H5Dclose, "open '" + name + "'"};
}

void GroupWriter::write_unit(const hdf5::Handle& dataset, const Unit& unit, const hdf5::Shape& shape) {
  if (unit.empty() || (all_equal(unit) && unit.front().empty())) return;
  const auto write = [&](const std::vector<std::string>& texts, const hdf5::Shape& extents) {
    if (small_)
      small_->add_unit(texts, extents);
    else
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
