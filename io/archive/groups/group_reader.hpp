#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "io/archive/groups/columns.hpp"
#include "io/archive/groups/rule.hpp"
#include "io/archive/groups/sizes.hpp"
#include "io/hdf5/array.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

class SampleReader;

/// Parts of an archive that a reader skips.
struct LeftOut {
  std::set<std::string> fields;  ///< paths
  bool evaluations = false;      ///< the filters' arrays over samples
};

/// Reads members as the layout describes them, with the same calls as GroupWriter.
/// - Shapes must agree. Numbers that become positions or sizes must be within bounds. The first problem is thrown as
/// DataError.
/// - With a list of problems (verification), all values are checked. Problems are added to the list, and reading
/// continues. Large arrays are checked block by block and left empty.
class GroupReader {
 public:
  static constexpr bool reads = true;

  GroupReader(hdf5::Handle group, std::vector<std::string>* problems, std::string path = {})
      : group_(std::move(group)),
        problems_(problems),
        problems_before_(problems ? problems->size() : 0),
        path_(std::move(path)) {}

  /// Whether all values are checked.
  bool verifies() const { return problems_ != nullptr; }
  /// The reader and the readers of its member groups skip these parts. `parts` must outlive all of these readers.
  void leave_out(const LeftOut& parts) { left_out_ = &parts; }
  bool leaves_evaluations() const { return left_out_ && left_out_->evaluations; }

  template <class Body>
  void group(const std::string& name, const Sizes& known, Body body) {
    guarded(name, [&] {
      GroupReader member = open_member(name);
      member.sizes_ = known;
      body(member);
    });
  }
  /// Reads the part if it exists.
  template <class Body>
  void optional_group(const std::string& name, bool /*present*/, const Sizes& known, Body body) {
    if (has(name)) group(name, known, body);
  }
  bool has(const std::string& name) const { return hdf5::has_link(group_.id(), name); }

  template <class T>
  void attribute(const std::string& name, T& value, const Rule& rule = rule::any) {
    guarded(name, [&] {
      auto stored = to_stored(value);
      read_attribute(name, stored);
      check(rule, stored);
      from_stored(stored, value);
    });
  }
  template <class T>
  void attribute_unless(const T& /*absent*/, const std::string& name, T& value, const Rule& rule = rule::any) {
    if (hdf5::has_attribute(group_.id(), name)) attribute(name, value, rule);
  }
  void constant_attribute(const std::string& name, const std::string& expected);
  void attribute_texts(const std::string& name, std::vector<std::string>& texts);
  void optional_attribute_texts(const std::string& name, std::vector<std::string>& texts) {
    if (hdf5::has_attribute(group_.id(), name)) attribute_texts(name, texts);
  }
  /// Reads all attributes, in order of their names.
  void attributes(std::vector<std::pair<std::string, std::string>>& pairs);

  void text(const std::string& name, std::string& value);
  void texts(const std::string& name, std::vector<std::string>& values, const Letters& letters);

  template <class Derived>
  void field(const std::string& name, Eigen::PlainObjectBase<Derived>& values, const Letters& letters, const Unit& = {},
             const Rule& rule = rule::any) {
    if (left_out_ && left_out_->fields.contains(path_ + "/" + name)) return;
    guarded(name, [&] {
      const hdf5::StoredArray array = open_array(name);
      check_numbers(array, letters, kind_of<Derived>());
      if (verifies() && array.elements() > most_at_once && !array.shape().empty())
        return judge_by_blocks(array, rule, values);
      shape_values(values, array.shape(), static_cast<Eigen::Index>(array.shape().front()));
      array.read(hdf5::memory_type<StoredOf<Derived>>(), values.data());
      check_values(rule, array.shape(), values, 0);
    });
  }
  /// Reads an array that was written block by block.
  template <class Source>
  void through_rows(const std::string& name, Source& values, const Letters& letters) {
    Eigen::MatrixXd all;
    field(name, all, letters);
    values = Source(std::move(all));
  }
  template <class Derived>
  void derived_field(const std::string& name, const Eigen::PlainObjectBase<Derived>&, const Letters& letters,
                     const Unit& = {}) {
    Derived unused;
    if (verifies()) field(name, unused, letters);
  }
  template <class Make>
  void optional_derived_field(const std::string& name, Make, const Letters& letters, const Unit& = {}) {
    std::invoke_result_t<Make> unused;
    if (verifies() && has(name)) field(name, unused, letters);
  }
  template <class Derived>
  void optional_field(const std::string& name, Eigen::PlainObjectBase<Derived>& values, const Letters& letters,
                      const Unit& = {}, const Rule& rule = rule::any) {
    if (has(name)) field(name, values, letters, {}, rule);
  }

  template <class Row, class... T>
  void table(const std::string& name, std::vector<Row>& rows, const Column<Row, T>&... columns) {
    rows.clear();
    const auto take = [&](Row& row) { rows.push_back(std::move(row)); };
    table_rows(name, nullptr, take, columns...);
  }
  template <class Row, class... T>
  void optional_table(const std::string& name, std::vector<Row>& rows, const Column<Row, T>&... columns) {
    if (has(name)) table(name, rows, columns...);
  }
  /// Reads a long table. Calls take(row) for each row.
  template <class Make, class Take, class Row, class... T>
  void table_rows(const std::string& name, const Make& /*make*/, Take take, const Column<Row, T>&... columns) {
    constexpr hsize_t rows_at_once = 16384;
    guarded(name, [&] {
      const hdf5::StoredArray array = open_array(name);
      for (hsize_t first = 0; first == 0 || first < array.elements(); first += rows_at_once) {
        const hdf5::TableRows read = hdf5::read_rows(array, {first, std::min(rows_at_once, array.elements() - first)});
        std::vector<Row> rows;
        (guarded(name, [&] { decode(read, columns, sizes_, verifies(), rows); }), ...);
        for (Row& row : rows) take(row);
      }
    });
  }

  /// Reads a value through its stored form. `body` reads the form. `from` makes the value, unless `body` found a
  /// problem.
  template <class Value, class To, class From, class Body>
  void through(Value& value, To, From from, Body body) {
    std::invoke_result_t<To, const Value&> stored{};
    body(stored);
    finish([&] { value = from(stored); });
  }
  /// Runs `step`, which uses members read from this group. Skips it if these members had problems.
  void finish(const std::function<void()>& step);
  /// Runs `step`, which only checks members. Skips it if these members had problems.
  void judge(const std::function<void()>& step) {
    if (verifies()) finish(step);
  }

  /// Binds a letter to an extent. For an extent that no array of the group has.
  void set_size(const std::string& letter, std::size_t extent) { sizes_.set(letter, extent); }
  /// Extent of a letter. 0 if no array has bound the letter.
  Eigen::Index size(const std::string& letter) const {
    return static_cast<Eigen::Index>(sizes_.find(letter).value_or(0));
  }

  /// The bound extents, for the reader of a member group.
  Sizes known(const Letters& letters) const { return sizes_.only(letters); }

 private:
  friend class SampleReader;

  static constexpr hsize_t most_at_once = hsize_t{1}
                                          << 20;  ///< verification reads an array in blocks of this many elements

  template <class Derived>
  using StoredOf = decltype(to_stored(std::declval<typename Derived::Scalar>()));
  template <class Derived>
  static constexpr H5T_class_t kind_of() {
    return std::is_floating_point_v<StoredOf<Derived>> ? H5T_FLOAT : H5T_INTEGER;
  }
  /// Resizes an array for rows of this shape.
  template <class Derived>
  static void shape_values(Eigen::PlainObjectBase<Derived>& values, const hdf5::Shape& shape, Eigen::Index rows) {
    if constexpr (Derived::IsVectorAtCompileTime)
      values.resize(rows);
    else
      values.resize(static_cast<Eigen::Index>(hdf5::element_count({shape.begin() + 1, shape.end()})), rows);
  }
  /// `shape`: shape of `values`. `first`: row of the array with which `values` begin.
  template <class Derived>
  void check_values(const Rule& rule, const hdf5::Shape& shape, const Eigen::PlainObjectBase<Derived>& values,
                    hsize_t first) const {
    if (!verifies() && !rule.index) return;
    // The file stores Eigen's 64-bit integers as std::int64_t.
    const auto* stored = reinterpret_cast<const StoredOf<Derived>*>(values.data());
    if (const std::string problem = broken(rule, sizes_, shape, stored, first); !problem.empty())
      throw DataError(problem);
  }
  template <class Derived>
  void judge_by_blocks(const hdf5::StoredArray& array, const Rule& rule, Eigen::PlainObjectBase<Derived>& values) {
    hdf5::Shape shape = array.shape();
    const hsize_t total = shape.front();
    const hsize_t at_once = std::max<hsize_t>(1, most_at_once * total / array.elements());
    for (hsize_t first = 0; first < total; first += at_once) {
      shape.front() = std::min(at_once, total - first);
      shape_values(values, shape, static_cast<Eigen::Index>(shape.front()));
      array.read_rows({first, shape.front()}, hdf5::memory_type<StoredOf<Derived>>(), values.data());
      check_values(rule, shape, values, first);
    }
    shape_values(values, shape, 0);
  }
  template <class Stored>
  void check(const Rule& rule, const Stored& stored) const {
    if (!verifies() && !rule.index) return;
    std::string problem;
    if constexpr (std::is_same_v<Stored, std::string>)
      problem = broken_text({stored}, true);
    else if constexpr (std::is_same_v<Stored, std::vector<std::ptrdiff_t>>)
      problem = broken(rule, sizes_, {stored.size()}, stored.data());
    else
      problem = broken(rule, sizes_, {}, &stored);
    if (!problem.empty()) throw DataError(problem);
  }
  void guarded(const std::string& name, const std::function<void()>& step);
  GroupReader open_member(const std::string& name) const;
  hdf5::StoredArray open_array(const std::string& name) const;
  /// Throws DataError if the values have another type or the extents disagree.
  void check_numbers(const hdf5::StoredArray& array, const Letters& letters, H5T_class_t kind);
  hdf5::StoredArray open_attribute(const std::string& name, H5T_class_t kind, bool scalar) const;
  void read_attribute(const std::string& name, std::string& value) const;
  void read_attribute(const std::string& name, std::vector<std::ptrdiff_t>& values) const {
    const hdf5::StoredArray array = open_attribute(name, H5T_INTEGER, false);
    values.resize(array.elements());
    if (!values.empty()) array.read(hdf5::memory_type<std::int64_t>(), values.data());
  }
  template <class Number>
  void read_attribute(const std::string& name, Number& value) const {
    const H5T_class_t kind = std::is_floating_point_v<Number> ? H5T_FLOAT : H5T_INTEGER;
    open_attribute(name, kind, true).read(hdf5::memory_type<Number>(), &value);
  }

  hdf5::Handle group_;
  std::vector<std::string>* problems_;
  std::size_t problems_before_;
  std::string path_;
  Sizes sizes_;
  const LeftOut* left_out_ = nullptr;
};

}  // namespace modebank
