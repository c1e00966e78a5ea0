#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/hdf5/array.hpp"
#include "io/hdf5/columns.hpp"
#include "io/hdf5/links.hpp"
#include "io/hdf5/rule.hpp"
#include "io/hdf5/sizes.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

/// The reading side of the layout's description: the same calls as GroupWriter. Without a list of problems the first
/// one is thrown as DataError; with one, problems are listed and reading goes on, which is what verification does.
class GroupReader {
 public:
  static constexpr bool reads = true;

  GroupReader(hdf5::Handle group, std::vector<std::string>* problems, std::string path = {})
      : group_(std::move(group)),
        problems_(problems),
        problems_before_(problems ? problems->size() : 0),
        path_(std::move(path)) {}

  /// What becomes of an array's values. Those that are judged alone leave a matrix its rows, without columns.
  enum class Values { kept, judged, unread };
  using ValuesOf = std::function<Values(const std::string& path)>;
  /// From here on fields fare as `use` says of their paths. It must outlive the reader.
  void read_fields(const ValuesOf& use) { use_ = &use; }

  template <class Body>
  void group(const std::string& name, const Sizes& known, Body body) {
    guarded(name, [&] {
      GroupReader member = open_member(name);
      member.sizes_ = known;
      body(member);
      member.check_links();
    });
  }
  /// Reads the part if it is there.
  template <class Body>
  void optional_group(const std::string& name, bool /*present*/, const Sizes& known, Body body) {
    if (has(name)) group(name, known, body);
  }
  bool has(const std::string& name) const;
  /// Reports members that lie elsewhere, also below members that nobody asked for.
  /// `elsewhere`: whether a link to another file may be there, by its place, the file and the place in that.
  void check_links(const hdf5::LinkAllowed& elsewhere = {});

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
  void optional_attribute(const std::string& name, T& value, const Rule& rule = rule::any) {
    if (hdf5::has_attribute(group_.id(), name)) attribute(name, value, rule);
  }
  template <class T>
  void attribute_unless(const T& /*absent*/, const std::string& name, T& value, const Rule& rule = rule::any) {
    optional_attribute(name, value, rule);
  }
  void constant_attribute(const std::string& name, const std::string& expected);
  void attribute_texts(const std::string& name, std::vector<std::string>& texts);
  void optional_attribute_texts(const std::string& name, std::vector<std::string>& texts) {
    if (hdf5::has_attribute(group_.id(), name)) attribute_texts(name, texts);
  }
  /// All attributes, in name order.
  void attributes(std::vector<std::pair<std::string, std::string>>& pairs);

  void text(const std::string& name, std::string& value);
  void texts(const std::string& name, std::vector<std::string>& values, const Letters& letters);

  template <class Derived>
  void field(const std::string& name, Eigen::PlainObjectBase<Derived>& values, const Letters& letters, const Unit& = {},
             const Rule& rule = rule::any) {
    const Values use = use_ ? (*use_)(path_ + "/" + name) : Values::kept;
    if (use == Values::unread) return void(has(name));  // asked for all the same
    guarded(name, [&] {
      using Stored = decltype(to_stored(std::declval<typename Derived::Scalar>()));
      constexpr bool real = std::is_floating_point_v<Stored>;
      const hdf5::StoredArray array = open_numbers(name, letters, real ? H5T_FLOAT : H5T_INTEGER);
      const auto extent = [&](std::size_t i) { return i < letters.size() ? array.shape()[i] : 1; };
      if constexpr (Derived::IsVectorAtCompileTime)
        values.resize(static_cast<Eigen::Index>(extent(0)));
      else
        values.resize(static_cast<Eigen::Index>(extent(1) * extent(2)), static_cast<Eigen::Index>(extent(0)));
      array.read(hdf5::memory_type<Stored>(), values.data());
      const std::string problem = broken(rule, sizes_, array.shape(), stored_values(values));
      if (!problem.empty()) throw DataError(problem);
      if (use == Values::judged)
        values.derived() =
            Derived(Derived::IsVectorAtCompileTime ? 0 : values.rows(), Derived::IsVectorAtCompileTime ? 1 : 0);
    });
  }
  /// One that is written block by block.
  template <class Source>
  void through_rows(const std::string& name, Source& values, const Letters& letters, const Rule& rule = rule::any) {
    Eigen::MatrixXd all;
    field(name, all, letters, {}, rule);
    values = Source(std::move(all));
  }
  template <class Derived>
  void derived_field(const std::string& name, const Eigen::PlainObjectBase<Derived>&, const Letters& letters,
                     const Unit& = {}, const Rule& rule = rule::any) {
    Derived unused;
    field(name, unused, letters, {}, rule);
  }
  template <class Make>
  void optional_derived_field(const std::string& name, Make, const Letters& letters, const Unit& = {},
                              const Rule& rule = rule::any) {
    std::invoke_result_t<Make> unused;
    if (has(name)) field(name, unused, letters, {}, rule);
  }
  template <class Derived>
  void optional_field(const std::string& name, Eigen::PlainObjectBase<Derived>& values, const Letters& letters,
                      const Unit& = {}, const Rule& rule = rule::any) {
    if (has(name)) field(name, values, letters, {}, rule);
  }

  template <class Row, class... T>
  void table(const std::string& name, std::vector<Row>& rows, const Column<Row, T>&... columns) {
    guarded(name, [&] {
      const hdf5::StoredArray array = open_array(name);
      (guarded(name, [&] { decode(array, columns, sizes_, rows); }), ...);
    });
  }

  template <class Row, class... T>
  void optional_table(const std::string& name, std::vector<Row>& rows, const Column<Row, T>&... columns) {
    if (has(name)) table(name, rows, columns...);
  }

  /// Works on the stored form of a value: `body` reads it, `from` makes the value of it, unless something is amiss.
  template <class Value, class To, class From, class Body>
  void through(Value& value, To, From from, Body body) {
    std::invoke_result_t<To, const Value&> stored{};
    body(stored);
    finish([&] { value = from(stored); });
  }
  /// Runs `step`, which relies on what has been read from this group, unless that had problems.
  void finish(const std::function<void()>& step);

  /// 0 for a letter that no array has bound.
  Eigen::Index size(const std::string& letter) const {
    return static_cast<Eigen::Index>(sizes_.find(letter).value_or(0));
  }

  /// What the arrays so far have decided, to hand on to a member group.
  Sizes known(const Letters& letters) const { return sizes_.only(letters); }

 private:
  /// Values as they were read: what is a 64-bit number to Eigen is one of ours.
  template <class Derived>
  static auto stored_values(const Eigen::PlainObjectBase<Derived>& values) {
    using Stored = decltype(to_stored(std::declval<typename Derived::Scalar>()));
    return reinterpret_cast<const Stored*>(values.data());
  }
  template <class Stored>
  void check(const Rule& rule, const Stored& stored) const {
    std::string problem;
    if constexpr (std::is_same_v<Stored, std::string>)
      problem = broken_text({stored}, true);
    else
      problem = broken(rule, sizes_, {}, &stored);
    if (!problem.empty()) throw DataError(problem);
  }
  void guarded(const std::string& name, const std::function<void()>& step);
  const std::string& require(const std::string& name) const;
  GroupReader open_member(const std::string& name) const;
  hdf5::StoredArray open_array(const std::string& name) const;
  hdf5::StoredArray open_numbers(const std::string& name, const Letters& letters, H5T_class_t kind);
  hdf5::StoredArray open_attribute(const std::string& name, H5T_class_t kind, bool scalar) const;
  void read_attribute(const std::string& name, std::string& value) const;
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
  const ValuesOf* use_ = nullptr;
  struct Member {
    bool hard;
    bool asked = false;
  };
  using Members = std::map<std::string, Member>;
  /// Listed at the first question: asking HDF5 for each of ten thousand takes longer.
  Members& members() const;
  mutable std::optional<Members> members_;
};

}  // namespace modebank
