#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/table/table_reader.hpp"

namespace modebank {

/// A column of a file of arrays (HDF5, MATLAB): a vector, a column of a matrix, or a member of a table.
struct StoredColumn {
  std::string group;  ///< path of the enclosing object, parts joined by dots; empty: the file itself
  std::string name;   ///< name within the group
  std::string type;   ///< type by the file: double, int32, datetime64[ns], text, ...
  std::string unit;   ///< empty: not in the file
  std::uint64_t rows = 0;
  bool whole = false;  ///< whole numbers, which whole_numbers() returns exactly
  bool text = false;
  double step_s = 0.0;  ///< above 0: no values are stored, and row k has the value k * step_s

  std::string path() const { return group.empty() ? name : group + "." + name; }
};

constexpr std::string_view nanoseconds_type = "datetime64[ns]";
/// Whether a column has times, by its type or its name.
bool is_time(const StoredColumn& column);

/// Columns of a file; each is read on request.
class ColumnStore {
 public:
  virtual ~ColumnStore() = default;
  virtual const std::vector<StoredColumn>& columns() const = 0;
  /// One line, with advice, for every object that gives no columns. These are MATLAB objects, with the code that
  /// converts them, and datasets that were never written or are in another file.
  virtual const std::vector<std::string>& left_out() const = 0;
  /// Reason why a column of that name is missing; empty if unknown.
  virtual std::string why_without(const std::string& /*column*/) const { return {}; }
  /// Rows of a column that were never written and so have the file's fill value.
  virtual std::vector<LineRange> unwritten(std::size_t /*column*/) const { return {}; }
  /// Read a stored column. Throw DataError, naming the column, on failure.
  virtual std::vector<double> numbers(std::size_t column) const = 0;
  virtual std::vector<std::int64_t> whole_numbers(std::size_t column) const = 0;
  virtual std::vector<std::string> texts(std::size_t column) const = 0;
};

/// Reads datasets of one or two dimensions (h5py, HDF5's own tools), compound tables, pandas' fixed and table formats,
/// and MATLAB's v7.3 files, which are HDF5. External links, external storage and virtual datasets are not followed, and
/// no pickle is executed. Throws ConfigurationError for a modebank archive, and for a file without columns, with advice
/// on its conversion. Throws DataError with HDF5's reason if HDF5 fails.
std::unique_ptr<ColumnStore> open_hdf5_columns(const std::filesystem::path& path);

/// Reads MATLAB's v4, v6 and v7 files with matio: vectors and matrices, also in nested structs. Throws as
/// open_hdf5_columns does.
std::unique_ptr<ColumnStore> open_mat_columns(const std::filesystem::path& path);

/// Simulink's structure with time. A signal's values get the signal's label as name, and the group of the time.
/// `labels`: texts of NAME.signals.label or NAME.signals[0].label by path.
void name_signals(std::vector<StoredColumn>& columns, const std::map<std::string, std::string>& labels);

/// A struct's scalar Ts is the sample time of its columns. Adds a column "time" to such groups unless they have times.
/// The column is as long as the most frequent number of rows in and below the group.
void add_sample_times(std::vector<StoredColumn>& columns, const std::map<std::string, double>& sample_time);

/// MATLAB code that converts an object of this class; "" for unknown classes.
std::string matlab_conversion(const std::string& class_name, const std::string& variable);

/// Names a MATLAB object, with the code of MATLAB and Python that converts it. Empty `class_name`: the class is
/// unknown. Empty `file`: Python's scipy cannot read the object.
std::string matlab_object(const std::string& class_name, const std::string& variable, const std::string& file);

/// The same for objects of the newer class system in files of version 7, for which matio returns neither name nor
/// class.
std::string matlab_objects_without_name();

/// Columns of a wider matrix are not listed.
constexpr std::uint64_t most_columns = 1000;
constexpr int deepest_group = 20;

}  // namespace modebank
