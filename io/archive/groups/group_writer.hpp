#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "io/archive/groups/columns.hpp"
#include "io/archive/groups/rule.hpp"
#include "io/archive/groups/sizes.hpp"
#include "io/hdf5/array.hpp"

namespace modebank {

/// Binds the letters of an array. Throws std::invalid_argument with the array's path if extents disagree.
void agree(Sizes& sizes, const std::string& place, const Letters& letters, const hdf5::Shape& shape);

/// Shape of an array with one sample, window or mode per column. If there are three extents, the middle one must be
/// bound. `all`: first extent of the whole array, if `values` are only some of its rows; otherwise 0.
hdf5::Shape shape_of(Sizes& sizes, const std::string& place, const Letters& letters, hsize_t rows, hsize_t cols,
                     bool is_vector, hsize_t all);
template <class Derived>
hdf5::Shape shape_of(Sizes& sizes, const std::string& place, const Letters& letters,
                     const Eigen::PlainObjectBase<Derived>& values, hsize_t all) {
  return shape_of(sizes, place, letters, static_cast<hsize_t>(values.rows()), static_cast<hsize_t>(values.cols()),
                  Derived::IsVectorAtCompileTime, all);
}

/// The attribute `units`. It has one unit for all entries, or one unit for each entry of the trailing extents.
void write_unit(const hdf5::Handle& dataset, const Unit& unit, const hdf5::Shape& shape);

/// Writes members into one group of a file, as the layout describes them (io/archive/layout.hpp). Arrays have one
/// sample, window or mode per column, so their memory is the row-major (count, ...) dataset.
class GroupWriter {
 public:
  static constexpr bool reads = false;

  explicit GroupWriter(hdf5::Handle group, std::string path = {}) : group_(std::move(group)), path_(std::move(path)) {}

  /// Makes or reopens a member group. Calls `body(writer)` with the writer of this group.
  template <class Body>
  void group(const std::string& name, const Sizes& known, Body body) {
    if (!complete()) return;
    GroupWriter member(make_group(name), path_ + "/" + name);
    member.sizes_ = known;
    body(member);
  }
  /// Writes a part. Writes nothing if the part is absent.
  template <class Body>
  void optional_group(const std::string& name, bool present, const Sizes& known, Body body) {
    if (present) group(name, known, body);
  }

  /// Later calls write windows `first` to `first + count - 1` of `total`. Arrays over windows (letter M) are written
  /// into these rows. All other arrays are written with the last part. `texts`: all values that texts may have.
  void windows_from(hsize_t first, hsize_t count, hsize_t total, std::vector<std::string> texts) {
    part_ = Part{first, count, total, std::move(texts)};
  }

  template <class T>
  void attribute(const std::string& name, const T& value, const Rule& = rule::any) {
    if (complete()) write_attribute(name, to_stored(value));
  }
  /// Writes a value unless it equals the default.
  template <class T>
  void attribute_unless(const T& absent, const std::string& name, const T& value, const Rule& = rule::any) {
    if (value != absent) attribute(name, value);
  }
  template <class T>
  void constant_attribute(const std::string& name, const T& value) {
    attribute(name, value);
  }
  void attribute_texts(const std::string& name, const std::vector<std::string>& texts) {
    if (complete()) hdf5::write_texts(group_.id(), hdf5::Place::attribute, name, texts, {texts.size()});
  }
  void optional_attribute_texts(const std::string& name, const std::vector<std::string>& texts) {
    if (!texts.empty()) attribute_texts(name, texts);
  }
  /// Writes every pair as an attribute.
  void attributes(const std::vector<std::pair<std::string, std::string>>& pairs) {
    for (const auto& [name, value] : pairs) attribute(name, value);
  }

  void text(const std::string& name, const std::string& value) {
    hdf5::write_texts(group_.id(), hdf5::Place::dataset, name, {value}, {});
  }
  void texts(const std::string& name, const std::vector<std::string>& values, const Letters& letters) {
    if (part_) return write_text_rows(name, values);
    agree(sizes_, path_ + "/" + name, letters, {values.size()});
    hdf5::write_texts(group_.id(), hdf5::Place::dataset, name, values, {values.size()});
  }

  /// A vector has one letter. A matrix has two letters, or three if each column is itself a matrix. The middle extent
  /// must then be bound.
  template <class Derived>
  void field(const std::string& name, const Eigen::PlainObjectBase<Derived>& values, const Letters& letters,
             const Unit& unit = {}, const Rule& = rule::any) {
    using Stored = decltype(to_stored(std::declval<typename Derived::Scalar>()));
    const bool rows_only = part_ && letters.front() == "M";
    if (!rows_only && !complete()) return;
    const hsize_t all = rows_only ? part_->total : 0;
    const hdf5::Shape shape = shape_of(sizes_, path_ + "/" + name, letters, values, all);
    if (rows_only) {
      const hdf5::Handle dataset = rows_of(name, hdf5::file_type<Stored>(), shape);
      hdf5::write_rows(dataset, hdf5::memory_type<Stored>(), {{part_->first, part_->count}}, values.data());
      return complete() ? write_unit(dataset, unit, shape) : void();
    }
    const hdf5::Handle dataset = hdf5::write_array(group_.id(), hdf5::Place::dataset, name, hdf5::file_type<Stored>(),
                                                   hdf5::memory_type<Stored>(), shape, values.data());
    write_unit(dataset, unit, shape);
  }
  /// Writes an array whose columns are computed during writing. `values` has windows(), components() and block(first,
  /// count).
  template <class Source>
  void through_rows(const std::string& name, const Source& values, const Letters& letters) {
    constexpr Eigen::Index rows_at_once = 16384;
    const hdf5::Shape shape{static_cast<hsize_t>(values.windows()), static_cast<hsize_t>(values.components())};
    agree(sizes_, path_ + "/" + name, letters, shape);
    const hdf5::Handle dataset = hdf5::create_rows(group_.id(), name, hdf5::file_type<double>(), shape);
    for (Eigen::Index first = 0; first == 0 || first < values.windows(); first += rows_at_once) {
      const Eigen::MatrixXd block = values.block(first, std::min(rows_at_once, values.windows() - first));
      hdf5::write_rows(dataset, hdf5::memory_type<double>(),
                       {{static_cast<hsize_t>(first), static_cast<hsize_t>(block.cols())}}, block.data());
    }
  }
  /// Writes an array that is computed from other arrays. It serves users of the file; modebank's readers ignore it.
  template <class Derived>
  void derived_field(const std::string& name, const Eigen::PlainObjectBase<Derived>& values, const Letters& letters,
                     const Unit& unit = {}) {
    field(name, values, letters, unit);
  }
  /// Writes a derived array that older files lack. `make` computes the array only for writing.
  template <class Make>
  void optional_derived_field(const std::string& name, Make make, const Letters& letters, const Unit& unit = {}) {
    optional_field(name, make(), letters, unit);
  }
  /// Writes an array unless it is empty.
  template <class Derived>
  void optional_field(const std::string& name, const Eigen::PlainObjectBase<Derived>& values, const Letters& letters,
                      const Unit& unit = {}, const Rule& = rule::any) {
    if (values.size() > 0) field(name, values, letters, unit);
  }

  template <class Row, class... T>
  void table(const std::string& name, const std::vector<Row>& rows, const Column<Row, T>&... columns) {
    write_column_units(hdf5::write_table(group_.id(), name, {encode(rows, columns)...}, rows.size()),
                       {columns.unit...});
  }

  /// Writes a table unless it is empty.
  template <class Row, class... T>
  void optional_table(const std::string& name, const std::vector<Row>& rows, const Column<Row, T>&... columns) {
    if (!rows.empty()) table(name, rows, columns...);
  }

  /// Writes a long table. make(append) calls append(rows) for each part of the rows. Rows need several times the memory
  /// of columns, so memory holds only one part.
  template <class Make, class Take, class Row, class... T>
  void table_rows(const std::string& name, Make make, const Take& /*take*/, const Column<Row, T>&... columns) {
    std::vector<hdf5::TableColumn> encoded{encode(std::vector<Row>(), columns)...};
    hsize_t count = 0;
    make([&](const std::vector<Row>& rows) {
      hdf5::append({encode(rows, columns)...}, encoded);
      count += rows.size();
    });
    write_column_units(hdf5::write_table(group_.id(), name, std::move(encoded), count), {columns.unit...});
  }

  /// Writes a value through its stored form. `to` makes the form, and `body` writes it.
  template <class Value, class To, class From, class Body>
  void through(const Value& value, To to, From, Body body) {
    const auto stored = to(value);
    body(stored);
  }

  /// Binds a letter to an extent. For an extent that no array of the group has.
  void set_size(const std::string& letter, std::size_t extent) { sizes_.set(letter, extent); }
  /// The bound extents, for the writer of a member group.
  Sizes known(const Letters& letters) const { return sizes_.only(letters); }

 private:
  friend class SampleWriter;

  hdf5::Handle make_group(const std::string& name);
  void write_attribute(const std::string& name, const std::string& value) {
    hdf5::write_texts(group_.id(), hdf5::Place::attribute, name, {value}, {});
  }
  void write_attribute(const std::string& name, const std::vector<std::ptrdiff_t>& values) {
    hdf5::write_array(group_.id(), hdf5::Place::attribute, name, hdf5::file_type<std::int64_t>(),
                      hdf5::memory_type<std::int64_t>(), {values.size()}, values.data());
  }
  template <class Number>
  void write_attribute(const std::string& name, Number value) {
    hdf5::write_array(group_.id(), hdf5::Place::attribute, name, hdf5::file_type<Number>(), hdf5::memory_type<Number>(),
                      {}, &value);
  }
  /// The dataset that receives the parts of windows. The first part creates it.
  hdf5::Handle rows_of(const std::string& name, hid_t file_type, const hdf5::Shape& shape) const;
  void write_column_units(const hdf5::Handle& table, const std::vector<std::string>& units);

  struct Part {
    hsize_t first, count, total;
    std::vector<std::string> texts;
  };
  bool complete() const { return !part_ || part_->first + part_->count == part_->total; }
  void write_text_rows(const std::string& name, const std::vector<std::string>& values);

  hdf5::Handle group_;
  std::string path_;
  Sizes sizes_;
  std::optional<Part> part_;
};

}  // namespace modebank
