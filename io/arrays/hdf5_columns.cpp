#include <fmt/format.h>

#include "io/arrays/array_reader.hpp"
#include "io/arrays/hdf5_objects.hpp"
#include "io/arrays/hdf5_walk.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using hdf5::Handle;

class Hdf5Columns : public ColumnStore {
  template <class Read>
  auto at_column(std::size_t column, Read&& read) const {
    const hdf5::Quiet quiet;
    const Hdf5Place& place = places_.at(column);
    try {
      const Handle file = hdf5_open_log(path_);
      const Handle data(H5Dopen2(file.id(), place.object.c_str(), H5P_DEFAULT), H5Dclose, "open the dataset");
      return read(data.id(), place);
    } catch (const DataError& error) {
      throw DataError(fmt::format("{}: column {}: {}", path_, columns_[column].path(), error.what()));
    }
  }

 public:
  explicit Hdf5Columns(const std::filesystem::path& path) : path_(path.string()) {
    const hdf5::Quiet quiet;
    Hdf5Walk walk(path_);
    try {
      const Handle file = hdf5_open_log(path_);
      const Handle root(H5Gopen2(file.id(), "/", H5P_DEFAULT), H5Gclose, "open the file's groups");
      refuse_archive(root.id());
      walk.group(root.id(), "", "", 0);
    } catch (const DataError& error) {
      throw DataError(fmt::format("{}: {}", path_, error.what()));
    }
    walk.turn_matrices();
    if (walk.columns.empty()) fail_empty(walk);
    columns_ = std::move(walk.columns);
    places_ = std::move(walk.places);
    left_out_ = std::move(walk.left_out);
    unwritten_ = std::move(walk.unwritten);
    add_sample_times(columns_, sample_times(walk));
    if (walk.tables == 1) leave_out_only_group();
  }

  const std::vector<StoredColumn>& columns() const override { return columns_; }
  const std::vector<std::string>& left_out() const override { return left_out_; }
  std::string why_without(const std::string& column) const override {
    const auto found = unwritten_.find(column);
    return found == unwritten_.end() ? std::string() : found->second;
  }
  std::vector<LineRange> unwritten(std::size_t column) const override {
    if (columns_.at(column).step_s > 0.0) return {};  // this column is computed, not stored
    return at_column(column, [](hid_t data, const Hdf5Place& place) {
      return hdf5_unwritten_lines(data, place.rows_along, place.element);
    });
  }
  std::vector<double> numbers(std::size_t column) const override { return read<double>(column, H5T_NATIVE_DOUBLE); }
  std::vector<std::int64_t> whole_numbers(std::size_t column) const override {
    return read<std::int64_t>(column, H5T_NATIVE_INT64);
  }
  std::vector<std::string> texts(std::size_t column) const override {
    return at_column(column, [&](hid_t data, const Hdf5Place& place) { return hdf5_read_texts(data, place.member); });
  }

 private:
  std::string path_;
  std::vector<StoredColumn> columns_;
  std::vector<Hdf5Place> places_;
  std::vector<std::string> left_out_;
  std::map<std::string, std::string> unwritten_;

  std::map<std::string, double> sample_times(const Hdf5Walk& walk) const {
    std::map<std::string, double> result;
    for (const auto& [group, place] : walk.sample_times) try {
        const Handle file = hdf5_open_log(path_);
        const Handle data(H5Dopen2(file.id(), place.object.c_str(), H5P_DEFAULT), H5Dclose, "open the dataset");
        hdf5_read(data.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, &result[group]);
      } catch (const DataError&) {
        result.erase(group);  // the group has no sample time
      }
    return result;
  }

  void refuse_archive(hid_t root) const {
    if (hdf5_text_attribute(root, "format").starts_with("modebank"))
      throw ConfigurationError(
          fmt::format("{} is an archive of modebank, not a log; use `modebank show` or `modebank report`", path_));
  }

  [[noreturn]] void fail_empty(const Hdf5Walk& walk) const {
    std::string why;
    for (const std::string& line : walk.left_out) why += "; " + line;
    throw ConfigurationError(fmt::format("{}: no column has numbers in two rows or more{}", path_, why));
  }

  /// If the file has only one table, removes the group's name from the columns' names.
  void leave_out_only_group() {
    const std::string group = columns_.front().group;
    for (const StoredColumn& column : columns_)
      if (column.group != group) return;
    for (StoredColumn& column : columns_) column.group.clear();
  }

  template <class T>
  std::vector<T> read(std::size_t column, hid_t memory) const {
    if (columns_[column].type.starts_with("bits")) {  // HDF5 can convert bits only to longer bits
      const std::vector<std::uint64_t> bits = read_as<std::uint64_t>(column, H5T_NATIVE_B64);
      return std::vector<T>(bits.begin(), bits.end());
    }
    return read_as<T>(column, memory);
  }

  template <class T>
  std::vector<T> read_as(std::size_t column, hid_t memory) const {
    return at_column(column, [&](hid_t data, const Hdf5Place& place) {
      const auto rows = static_cast<std::size_t>(columns_[column].rows);
      if (!place.member.empty()) return hdf5_read_member<T>(data, place.member, place.element, memory, rows);
      return hdf5_read_line<T>(data, place.rows_along, place.element, memory, rows);
    });
  }
};

}  // namespace

bool is_hdf5(const std::filesystem::path& path) {
  const hdf5::Quiet quiet;
  return H5Fis_hdf5(path.c_str()) > 0;
}

std::unique_ptr<ColumnStore> open_hdf5_columns(const std::filesystem::path& path) {
  return std::make_unique<Hdf5Columns>(path);
}

}  // namespace modebank
