#include "io/archive/groups/sample_reader.hpp"

#include <algorithm>
#include <cstring>

namespace modebank {

SampleReader::SampleReader(GroupReader& group, hsize_t total) : group_(group), total_(total) {
  group_.sizes_.set("S", total);
}

SampleReader::Column& SampleReader::column_of(const std::string& name) {
  const auto [found, is_new] = columns_.try_emplace(name);
  Column& column = found->second;
  if (is_new && group_.has(name)) group_.guarded(name, [&] { column.array.emplace(group_.open_array(name)); });
  return column;
}

void SampleReader::read_rows(Column& column, hid_t memory_type, std::size_t cell_bytes, void* values) const {
  constexpr hsize_t block_rows = 4096;
  if (run_.count >= block_rows) return column.array->read_rows(run_, memory_type, values);
  const hdf5::Shape& shape = column.array->shape();
  const std::size_t row_bytes = cell_bytes * hdf5::element_count({shape.begin() + 1, shape.end()});
  if (run_.first < column.block.first || run_.end() > column.block.end()) {
    column.block = {run_.first, std::min(block_rows, total_ - run_.first)};
    column.cells.resize(row_bytes * column.block.count);
    column.array->read_rows(column.block, memory_type, column.cells.data());
  }
  if (row_bytes * run_.count > 0)
    std::memcpy(values, column.cells.data() + row_bytes * (run_.first - column.block.first), row_bytes * run_.count);
}

}  // namespace modebank
