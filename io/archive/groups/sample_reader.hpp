#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "io/archive/groups/group_reader.hpp"

namespace modebank {

/// Reads arrays over the samples of all runs (letter S). Returns the rows of one run. If runs are short, one read
/// covers several runs.
class SampleReader {
 public:
  static constexpr bool reads = true;

  /// Reads arrays of `group`, which must outlive this reader. `total`: number of samples of all runs.
  SampleReader(GroupReader& group, hsize_t total);

  /// Selects the run whose fields are read next, by its rows. `wanted`: the fields to read; null: all fields.
  void begin_run(const hdf5::Rows& rows, const std::set<std::string>* wanted = nullptr) {
    run_ = rows;
    wanted_ = wanted;
  }

  /// Reads an array that every run has.
  template <class Derived>
  void field(const std::string& name, Eigen::PlainObjectBase<Derived>& values, const Letters& letters, const Unit& = {},
             const Rule& rule = rule::any) {
    if (run_.count == 0 || (wanted_ && !wanted_->contains(name))) return;
    Column& column = column_of(name);
    if (column.has_problem) return;
    column.has_problem = true;
    group_.guarded(name, [&] {
      if (!column.array) throw DataError("is missing");
      read_run(column, letters, values);
      hdf5::Shape shape = column.array->shape();
      shape.front() = run_.count;
      group_.check_values(rule, shape, values, run_.first);
      column.has_problem = false;
    });
  }
  /// Reads an array that a run may lack. The result is empty if no run has the array, or if all rows of this run are
  /// NaN or -1.
  template <class Derived>
  void optional_field(const std::string& name, Eigen::PlainObjectBase<Derived>& values, const Letters& letters,
                      const Unit& unit = {}, const Rule& rule = rule::any) {
    if ((wanted_ && !wanted_->contains(name)) || !column_of(name).array) return;
    field(name, values, letters, unit, rule);
    bool missing = true;
    if constexpr (std::is_floating_point_v<typename Derived::Scalar>)
      missing = values.array().isNaN().all();
    else
      missing = (values.array() == -1).all();
    if (missing) values.derived() = Derived();
  }
  void finish(const std::function<void()>& step) { group_.finish(step); }

 private:
  /// One array and those of its rows that are already in memory.
  struct Column {
    std::optional<hdf5::StoredArray> array;
    bool has_problem = false;  ///< already reported
    hdf5::Rows block = {};
    std::string cells = {};
  };
  Column& column_of(const std::string& name);
  /// The run's rows as they are in memory, with `cell_bytes` per number.
  void read_rows(Column& column, hid_t memory_type, std::size_t cell_bytes, void* values) const;
  template <class Derived>
  void read_run(Column& column, const Letters& letters, Eigen::PlainObjectBase<Derived>& values) {
    using Number = GroupReader::StoredOf<Derived>;
    group_.check_numbers(*column.array, letters, GroupReader::kind_of<Derived>());
    GroupReader::shape_values(values, column.array->shape(), static_cast<Eigen::Index>(run_.count));
    read_rows(column, hdf5::memory_type<Number>(), sizeof(Number), values.data());
  }

  GroupReader& group_;
  hsize_t total_;
  hdf5::Rows run_;
  const std::set<std::string>* wanted_ = nullptr;
  std::map<std::string, Column> columns_;
};

}  // namespace modebank
