#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "io/hdf5/object_header.hpp"

namespace modebank::hdf5 {

/// How wide a file's addresses and sizes are, in bytes, as its superblock says.
struct Widths {
  std::size_t address = 8, size = 8;
};

/// Why HDF5 must not be handed an object header: it would read or write beyond what it has.
struct Unsound {
  std::string reason;
};

/// Throws Unsound with the reason.
void require_sound(bool sound, const char* reason);

/// Takes a datatype as HDF5 1.10 decodes it, which knows no end of it, and returns the bytes of an element on disk.
/// Throws Unsound where its parts do not fit each other, NotKnownHere where it does not end.
std::uint64_t take_sound_type(ByteReader& reader, const Widths& widths, int depth = 0);

/// Takes extents and returns how many elements they hold. Throws as take_sound_type.
std::uint64_t take_sound_space(ByteReader& reader, const Widths& widths);

}  // namespace modebank::hdf5
