#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "io/archive/groups/group_writer.hpp"

namespace modebank {

/// Writes arrays over the samples of all runs (letter S). Each quantity has one array, and each run has its rows in
/// this array.
/// - Rows of several runs are collected into blocks. One call per array writes a block.
/// - Runs may come in any order, but each only once.
/// - An array that no run has is absent. If only some runs have an array, the rows of all other runs are NaN or -1.
class SampleWriter {
 public:
  static constexpr bool reads = false;

  /// Writes arrays into the group. `total`: number of samples of all runs.
  SampleWriter(const GroupWriter& group, hsize_t total);

  /// Selects the run whose fields are written next, by its rows.
  void begin_run(const hdf5::Rows& rows);
  /// Writes the collected rows.
  void flush();
  /// Flushes. Throws std::invalid_argument unless all rows were written.
  void finish();

  /// Writes an array that every run has.
  template <class Derived>
  void field(const std::string& name, const Eigen::PlainObjectBase<Derived>& values, const Letters& letters,
             const Unit& unit = {}, const Rule& = rule::any) {
    using Number = decltype(to_stored(std::declval<typename Derived::Scalar>()));
    if (run_.count == 0) return;
    sizes_.set(letters.front(), run_.count);
    hdf5::Shape shape = shape_of(sizes_, path_ + "/" + name, letters, values, 0);
    shape.front() = total_;
    put(column_of<Number>(name, shape, unit), values.data());
  }
  /// Writes an array unless it is empty.
  template <class Derived>
  void optional_field(const std::string& name, const Eigen::PlainObjectBase<Derived>& values, const Letters& letters,
                      const Unit& unit = {}, const Rule& = rule::any) {
    if (values.size() > 0) field(name, values, letters, unit);
  }

 private:
  /// One array and its rows that wait to be written, as they are in memory.
  struct Column {
    std::string name;
    hdf5::Handle dataset;
    hid_t memory_type;
    std::string missing_row;
    std::string waiting = {};
    bool has_run = false;
  };
  template <class Number>
  static Number missing() {
    if constexpr (std::is_floating_point_v<Number>)
      return std::numeric_limits<Number>::quiet_NaN();
    else
      return -1;
  }
  template <class Number>
  Column& column_of(const std::string& name, const hdf5::Shape& shape, const Unit& unit) {
    const Number none = missing<Number>();
    const std::string bytes(reinterpret_cast<const char*>(&none), sizeof none);
    return column_of(name, hdf5::file_type<Number>(), hdf5::memory_type<Number>(), bytes, shape, unit);
  }
  Column& column_of(const std::string& name, hid_t file_type, hid_t memory_type, const std::string& missing,
                    const hdf5::Shape& shape, const Unit& unit);
  /// Adds the run's rows to an array.
  void put(Column& column, const void* values);
  static void fill(Column& column, hsize_t rows);
  void write_missing(const Column& column) const;
  /// Writes missing values into the arrays that the run lacks.
  void end_run();

  const hdf5::Handle group_;
  std::string path_;
  Sizes sizes_;
  hsize_t total_, came_ = 0;  ///< total number of rows, and number of rows from the runs so far
  hdf5::Rows run_;
  bool at_once_ = false;  ///< the run's rows are written directly from the caller's memory
  std::vector<Column> columns_;
  std::vector<hdf5::Rows> waiting_;  ///< the rows whose values wait to be written
  hsize_t waiting_rows_ = 0;
};

}  // namespace modebank
