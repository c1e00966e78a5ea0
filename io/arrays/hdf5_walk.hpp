#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "io/arrays/stored_columns.hpp"
#include "io/hdf5/array.hpp"

namespace modebank {

/// Location of a column. A column is a line of a dataset of one or two dimensions, or an element of a member in a
/// table's rows.
struct Hdf5Place {
  std::string object;               ///< path of the dataset in the file
  std::vector<std::string> member;  ///< path of the member in compounds; empty: the dataset itself contains numbers or
                                    ///< texts
  hsize_t element = 0;              ///< index within a member that is an array, otherwise the line of a matrix
  hsize_t rows_along = 0;           ///< the dimension whose index is the row
};

/// Walks through a file and lists its columns.
class Hdf5Walk {
 public:
  /// `named`: the file's name, for the lines about its objects.
  explicit Hdf5Walk(std::string named) : file(std::move(named)) {}

  const std::string file;
  std::vector<StoredColumn> columns;
  std::vector<Hdf5Place> places;
  std::vector<std::string> left_out;              ///< one line for each object without columns
  std::map<std::string, std::string> unwritten;   ///< datasets that were never written: the reason, by column name
  std::map<std::string, Hdf5Place> sample_times;  ///< groups with a scalar Ts
  int tables = 0;                                 ///< number of tables with compound rows

  void group(hid_t id, const std::string& path, const std::string& name, int depth);

  /// Chooses which dimension of a matrix counts rows. It is the dimension that is as long as a vector of the file. If
  /// there is none, it is the usual dimension of the program that wrote the file.
  void turn_matrices();

 private:
  static constexpr std::size_t most_objects = 100'000;
  struct Matrix {
    StoredColumn column;
    std::string object;
    hdf5::Shape shape;
    hsize_t habit;
  };
  std::vector<Matrix> matrices_;
  std::set<haddr_t> seen_;

  void add(StoredColumn column, Hdf5Place place);

  static bool is_object(hid_t id, const std::string& made);

  void note_object(const std::string& made, const std::string& name);

  void note_array(const std::string& name, const std::string& path);

  void note_foreign(const std::string& path);

  void link(hid_t parent, const std::string& member, const std::string& path, const std::string& group_name, int depth);

  void dataset(hid_t id, const std::string& path, const std::string& group_name, const std::string& name, int depth);

  void plain(StoredColumn column, const std::string& path, const hdf5::Shape& shape, hsize_t habit);

  /// Adds the members of a table's rows, including members in nested compounds.
  void compound(hid_t type, const hdf5::Shape& shape, const Hdf5Place& place, const std::string& group_name);
  void member(hid_t type, hsize_t rows, const Hdf5Place& place, const std::string& group_name);

  /// MATLAB stores each field of a struct array as a dataset of references. Each reference belongs to one struct.
  void struct_array(hid_t id, hid_t type, const hdf5::Shape& shape, const std::string& group_name,
                    const std::string& name, int depth);
};

}  // namespace modebank
