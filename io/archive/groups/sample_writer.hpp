#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "io/archive/groups/group_writer.hpp"

namespace modebank {

/// The writing side of arrays over the samples of all runs (letter S): one array per quantity, in which each run has
/// its rows. Rows are gathered over runs into blocks; a block is written by one call per array. Runs come in any order,
/// each once. An array that no run has is absent; a run without it has NaN or -1 in its rows.
class SampleWriter {
 public:
  static constexpr bool reads = false;

  /// Arrays go into the group; `total`: samples of all runs.
  SampleWriter(const GroupWriter& group, hsize_t total);

  /// From here on fields are those of the run that has these rows.
  void begin_run(const hdf5::Rows& rows);
  /// Writes the rows that were gathered.
  void flush();
  /// Flushes; throws std::invalid_argument unless all rows have come.
  void finish();

  /// An array that every run has.
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
  /// An empty array is left out.
  template <class Derived>
  void optional_field(const std::string& name, const Eigen::PlainObjectBase<Derived>& values, const Letters& letters,
                      const Unit& unit = {}, const Rule& = rule::any) {
    if (values.size() > 0) field(name, values, letters, unit);
  }

 private:
  /// One array: the rows that wait, as they are in memory.
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
  /// The run's rows of an array.
  void put(Column& column, const void* values);
  static void fill(Column& column, hsize_t rows);
  void write_missing(const Column& column) const;
  /// Completes the arrays that the run lacks.
  void end_run();

  const hdf5::Handle group_;
  std::string path_;
  Sizes sizes_;
  hsize_t total_, came_ = 0;  ///< rows, and those of the runs that came
  hdf5::Rows run_;
  bool at_once_ = false;  ///< the run is written as it comes, from where it is
  std::vector<Column> columns_;
  std::vector<hdf5::Rows> waiting_;  ///< whose rows the arrays' waiting values are
  hsize_t waiting_rows_ = 0;
};

}  // namespace modebank
