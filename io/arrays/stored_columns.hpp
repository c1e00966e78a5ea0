#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ident/base/not_a_number.hpp"
#include "io/table/table_reader.hpp"

namespace modebank {

/// A column of a file of arrays (HDF5, MATLAB): a vector, a column of a matrix, or a member of a table.
struct StoredColumn {
  std::string group;  ///< path of the enclosing object, with dots between its parts; empty: the file itself
  std::string name;   ///< name within the group
  std::string type;   ///< type in the file: double, int32, text, ...
  std::string unit;   ///< empty if the file states no unit
  std::uint64_t rows = 0;
  bool whole = false;  ///< the values are whole numbers; whole_numbers() returns them exactly
  bool text = false;
  double scale = 1.0, offset = 0.0, fill = not_a_number;  ///< a value is scale * stored + offset; fill is missing
  double step_s = 0.0;  ///< > 0: the file has no values; k stands for that of row k, and scale is step_s

  std::string path() const { return group.empty() ? name : group + "." + name; }
};

/// Whether a column contains times. Its name shows this.
bool is_time(const StoredColumn& column);

/// The columns of a file. A column is read when it is requested.
class ColumnStore {
 public:
  virtual ~ColumnStore() = default;
  virtual const std::vector<StoredColumn>& columns() const = 0;
  /// One line, with advice, for every object that has no columns. Such objects are MATLAB objects and datasets that
  /// were never written or are in another file. For MATLAB objects the line has the code that converts them.
  virtual const std::vector<std::string>& left_out() const = 0;
  /// Reason why a column of that name is missing. Empty if the reason is unknown.
  virtual std::string why_without(const std::string& /*column*/) const { return {}; }
  /// Rows of a column that were never written. They contain the file's fill value.
  virtual std::vector<LineRange> unwritten(std::size_t /*column*/) const { return {}; }
  /// These functions read a stored column. On failure they throw DataError, which names the column.
  virtual std::vector<double> numbers(std::size_t column) const = 0;
  virtual std::vector<std::int64_t> whole_numbers(std::size_t column) const = 0;
  virtual std::vector<std::string> texts(std::size_t column) const = 0;
};

/// Reads datasets of one or two dimensions (h5py, HDF5's own tools), compound tables
/// and MATLAB's v7.3 files, which are HDF5. External links, external storage and virtual datasets are not followed.
/// Throws ConfigurationError for a modebank archive. Throws it, with advice on conversion, for a
/// file without columns. Throws DataError with HDF5's reason if HDF5 fails.
std::unique_ptr<ColumnStore> open_hdf5_columns(const std::filesystem::path& path);

/// Reads vectors and matrices of MATLAB's v4, v6 and v7 files with matio, including those in nested structs. Throws the
/// same exceptions as open_hdf5_columns.
std::unique_ptr<ColumnStore> open_mat_columns(const std::filesystem::path& path);

/// A scalar Ts in a struct is the sample time of the struct's columns. Adds a column "time" to each struct that has Ts
/// but no times. The new column has the most frequent length of the columns in the struct and its substructs.
void add_sample_times(std::vector<StoredColumn>& columns, const std::map<std::string, double>& sample_time);

/// MATLAB code that converts an object of this class. Empty if the class is unknown.
std::string matlab_conversion(const std::string& class_name, const std::string& variable);

/// A line that names a MATLAB object and has the code of MATLAB and Python that converts it. `class_name` is empty if
/// the class is unknown. `file` is empty if Python's scipy cannot read the object.
std::string matlab_object(const std::string& class_name, const std::string& variable, const std::string& file);

/// A line for objects of the newer class system in files of version 7. matio returns neither the name nor the class of
/// these objects.
std::string matlab_objects_without_name();

/// A line that names an array that is no table, with lines of Python that write it as text, the longest dimension as
/// rows. `read`: the statements that make it `a`; `cells`: the arrays if `a` has objects.
std::string not_a_table(const std::string& name, const std::string& read, const std::string& cells);

/// A matrix with more columns than this is not listed column by column.
constexpr std::uint64_t most_columns = 1000;
constexpr int deepest_group = 20;

}  // namespace modebank
