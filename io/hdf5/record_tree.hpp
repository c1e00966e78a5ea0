#pragma once

#include <hdf5.h>

#include <functional>
#include <string>
#include <string_view>

#include "io/hdf5/type_soundness.hpp"

namespace modebank::hdf5 {

/// `count` bytes at an address as the file's objects state it. Throws Unsound where there are not so many.
using BytesAt = std::function<std::string(haddr_t address, std::uint64_t count)>;

/// What a tree's records are: HDF5's number of their kind, and their size.
struct RecordKind {
  std::uint64_t type;
  std::size_t bytes;
};

/// Hands on every record of a B-tree of version 2 as HDF5 1.10 finds them, which believes a node's number of records
/// and a record's size without knowing what its own memory of them holds. Throws Unsound for a tree of another kind, or
/// one that is not as HDF5 writes it.
void each_record(const BytesAt& bytes_at, const Widths& widths, haddr_t address, const RecordKind& kind,
                 const std::function<void(std::string_view)>& see);

}  // namespace modebank::hdf5
