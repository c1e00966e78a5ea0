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

/// What a file of arrays (HDF5, MATLAB) holds in one column: a vector, a column of a matrix, a member of a table.
struct StoredColumn {
  std::string group;  ///< path of what holds it, parts joined by dots; empty: the file itself
  std::string name;   ///< in the group
  std::string type;   ///< as the file says: double, int32, datetime64[ns], text, ...
  std::string unit;   ///< empty: the file does not say
  std::uint64_t rows = 0;
  bool whole = false;  ///< whole numbers, which whole_numbers gives exactly
  bool text = false;
  double step_s = 0.0;  ///< above 0: the file stores no values, row k is k * step_s

  std::string path() const { return group.empty() ? name : group + "." + name; }
};

constexpr std::string_view nanoseconds_type = "datetime64[ns]";
/// Whether a column holds times, by its type or its name.
bool is_time(const StoredColumn& column);

/// A file's columns, one after another, each read when it is asked for.
class ColumnStore {
 public:
  virtual ~ColumnStore() = default;
  virtual const std::vector<StoredColumn>& columns() const = 0;
  /// A line for everything that gives no columns, saying what helps: objects of MATLAB with the lines that convert
  /// them, datasets that were never written or lie in another file.
  virtual const std::vector<std::string>& left_out() const = 0;
  /// Why a column of that name is not there; empty when there is nothing to say.
  virtual std::string why_without(const std::string& /*column*/) const { return {}; }
  /// Rows of a column that were never written: they read as the file's fill value.
  virtual std::vector<LineRange> unwritten(std::size_t /*column*/) const { return {}; }
  /// Throw DataError, naming the column, when it cannot be read. Of columns that the file stores.
  virtual std::vector<double> numbers(std::size_t column) const = 0;
  virtual std::vector<std::int64_t> whole_numbers(std::size_t column) const = 0;
  virtual std::vector<std::string> texts(std::size_t column) const = 0;
};

/// Datasets of one or two dimensions (h5py, HDF5's own tools), compound tables, pandas' fixed and table formats, and
/// MATLAB's v7.3 files, which are HDF5. External links, external storage and virtual datasets are not followed, and no
/// pickle is executed. Throws ConfigurationError for an archive of ours and for a file without any column, saying how
/// to convert what it does hold; DataError, with HDF5's reason, where HDF5 fails.
std::unique_ptr<ColumnStore> open_hdf5_columns(const std::filesystem::path& path);

/// MATLAB's v4, v6 and v7 files, by matio: vectors and matrices, also of nested structs. Throws as open_hdf5_columns
/// does.
std::unique_ptr<ColumnStore> open_mat_columns(const std::filesystem::path& path);

/// Simulink's structure with time: values of signals get the signal's label and stand beside the time. `labels`: text
/// of NAME.signals.label or NAME.signals[0].label by path.
void name_signals(std::vector<StoredColumn>& columns, const std::map<std::string, std::string>& labels);

/// A struct's scalar Ts is the sample time of its columns: adds the column "time" to the groups that `sample_time`
/// names, for the commonest number of rows in them and below, unless these have times.
void add_sample_times(std::vector<StoredColumn>& columns, const std::map<std::string, double>& sample_time);

/// The line of MATLAB that turns an object of that class into what is read here; "" when none is known.
std::string matlab_conversion(const std::string& class_name, const std::string& variable);

/// An object of MATLAB and the lines of MATLAB and of Python that convert it. `class_name` empty: not known;
/// `file` empty: Python's scipy does not read it.
std::string matlab_object(const std::string& class_name, const std::string& variable, const std::string& file);

/// The same for objects of the newer class system in files of version 7, of which matio gives neither name nor class.
std::string matlab_objects_without_name();

/// Of a matrix wider than this nobody names a column.
constexpr std::uint64_t most_columns = 1000;
constexpr int deepest_group = 20;

}  // namespace modebank
