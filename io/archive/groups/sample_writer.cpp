#include "io/archive/groups/sample_writer.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace modebank {

namespace {

constexpr hsize_t block_rows = 65536;
/// HDF5 joins the parts of a selection. The time for this grows with the square of the number of parts.
constexpr std::size_t most_stretches = 256;

}  // namespace

SampleWriter::SampleWriter(const GroupWriter& group, hsize_t total)
    : group_(hdf5::open_group(group.group_.id(), ".")), path_(group.path_), sizes_(group.sizes_), total_(total) {}

void SampleWriter::begin_run(const hdf5::Rows& rows) {
  end_run();
  // HDF5 writes the values of a selection in the order of its rows.
  const bool goes_back = !waiting_.empty() && rows.first < waiting_.back().end();
  const bool follows = !waiting_.empty() && rows.first == waiting_.back().end();
  if (goes_back || waiting_rows_ + rows.count > block_rows || (!follows && waiting_.size() >= most_stretches)) flush();
  run_ = rows;
  at_once_ = rows.count >= block_rows;
}

SampleWriter::Column& SampleWriter::column_of(const std::string& name, hid_t file_type, hid_t memory_type,
                                              const std::string& missing, const hdf5::Shape& shape, const Unit& unit) {
  const auto found = std::find_if(columns_.begin(), columns_.end(), [&](const Column& c) { return c.name == name; });
  if (found != columns_.end()) return *found;
  const bool late = came_ > 0;
  Column column{
      name, hdf5::create_rows(group_.id(), name, file_type, memory_type, shape, missing.data(), late), memory_type, {}};
  write_unit(column.dataset, unit, shape);
  const hsize_t entries = hdf5::element_count({shape.begin() + 1, shape.end()});
  for (hsize_t i = 0; i < entries; ++i) column.missing_row += missing;
  fill(column, waiting_rows_);
  return columns_.emplace_back(std::move(column));
}

void SampleWriter::put(Column& column, const void* values) {
  column.has_run = true;
  if (at_once_) return hdf5::write_rows(column.dataset, column.memory_type, {run_}, values);
  column.waiting.append(static_cast<const char*>(values), column.missing_row.size() * run_.count);
}

void SampleWriter::fill(Column& column, hsize_t rows) {
  for (hsize_t i = 0; i < rows; ++i) column.waiting += column.missing_row;
}

void SampleWriter::write_missing(const Column& column) const {
  std::string block;
  for (hsize_t i = 0; i < block_rows; ++i) block += column.missing_row;
  for (hsize_t first = run_.first; first < run_.end(); first += block_rows)
    hdf5::write_rows(column.dataset, column.memory_type, {{first, std::min(block_rows, run_.end() - first)}},
                     block.data());
}

void SampleWriter::end_run() {
  if (run_.count == 0) return;
  for (Column& column : columns_)
    if (!std::exchange(column.has_run, false)) at_once_ ? write_missing(column) : fill(column, run_.count);
  came_ += run_.count;
  if (!at_once_) {
    if (!waiting_.empty() && waiting_.back().end() == run_.first)
      waiting_.back().count += run_.count;
    else
      waiting_.push_back(run_);
    waiting_rows_ += run_.count;
  }
  run_ = {};
}

void SampleWriter::flush() {
  end_run();
  for (Column& column : columns_) {
    hdf5::write_rows(column.dataset, column.memory_type, waiting_, column.waiting.data());
    column.waiting.clear();
  }
  waiting_.clear();
  waiting_rows_ = 0;
}

void SampleWriter::finish() {
  flush();
  if (came_ != total_)
    throw std::invalid_argument(path_ + " has values of " + std::to_string(came_) + " of " + std::to_string(total_) +
                                " samples");
}

}  // namespace modebank
