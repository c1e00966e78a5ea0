#pragma once

#include <functional>

#include "io/hdf5/type_soundness.hpp"

namespace modebank::hdf5 {

/// Bytes of an element of the datatype that an object header holds; throws Unsound where it holds none of its own.
using TypeAt = std::function<std::uint64_t(haddr_t)>;

/// Throws Unsound where HDF5 1.10 would read beyond the message when it decodes it, or would later read beyond what it
/// decoded. Kinds that it decodes with care, or that no reader asks for, are not looked at.
void require_sound_message(const RawMessage& message, const Widths& widths, const TypeAt& type_at);

/// Throws Unsound for what no header of an archive holds, whose arrays lie in the file in one piece: HDF5's code for
/// all else is then out of reach.
void require_of_an_archive(const RawMessage& message);

/// Kinds of messages that may lie outside of the header.
inline constexpr std::uint64_t link_kind = 6, attribute_kind = 12, link_info_kind = 2, attribute_info_kind = 21;

/// Where many links or attributes of an object lie: in a heap, which trees by name and by order lead to; the largest
/// number where there is none.
struct DensePlaces {
  haddr_t heap, by_name, by_order;
};
/// Of a message of one of the two kinds that say so.
DensePlaces dense_places(const RawMessage& message, const Widths& widths);

}  // namespace modebank::hdf5
