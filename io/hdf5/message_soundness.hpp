#pragma once

#include <functional>

#include "io/hdf5/type_soundness.hpp"

namespace modebank::hdf5 {

/// Bytes of an element of the datatype that an object header holds; throws Unsound where it holds none of its own.
using TypeAt = std::function<std::uint64_t(haddr_t)>;

/// Throws Unsound where HDF5 1.10 would read beyond the message when it decodes it, or would later read beyond what it
/// decoded. Kinds that it decodes with care, or that no reader asks for, are not looked at.
void require_sound_message(const RawMessage& message, const Widths& widths, const TypeAt& type_at);

}  // namespace modebank::hdf5
