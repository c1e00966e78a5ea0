#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

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
  /// A line for every object of MATLAB, which gives no columns, with the lines that convert it.
  virtual const std::vector<std::string>& objects() const = 0;
  /// Throw DataError, naming the column, when it cannot be read. Of columns that the file stores.
  virtual std::vector<double> numbers(std::size_t column) const = 0;
  virtual std::vector<std::int64_t> whole_numbers(std::size_t column) const = 0;
  virtual std::vector<std::string> texts(std::size_t column) const = 0;
};

/// Datasets of one or two dimensions (h5py, HDF5's own tools), compound tables, pandas' fixed and table formats, and
/// MATLAB's v7.3 files, which are HDF5. Nothing outside the file is followed (external links and storage, virtual
/// datasets), no filter is loaded that HDF5 does not bring, no pickle is executed. Throws ConfigurationError for an
/// archive of ours and for a file without any column, saying how to convert what it does hold; DataError for a damaged
/// one.
std::unique_ptr<ColumnStore> open_hdf5_columns(const std::filesystem::path& path);

/// MATLAB's v4, v6 and v7 files: vectors and matrices, also of nested structs. Throws as open_hdf5_columns does.
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

/// Compressed data is at most this many times smaller than what it unpacks to (deflate's limit is 1032).
constexpr std::uint64_t most_expansion = 1100;
/// Of a matrix wider than this nobody names a column.
constexpr std::uint64_t most_columns = 1000;
constexpr int deepest_group = 20;

}  // namespace modebank
