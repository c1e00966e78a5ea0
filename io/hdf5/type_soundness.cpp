#include "io/hdf5/type_soundness.hpp"

#include "io/hdf5/array.hpp"

namespace modebank::hdf5 {

void require_sound(bool sound, const char* reason) {
  if (!sound) throw Unsound{reason};
}

namespace {

/// What every datatype begins with.
struct TypeStart {
  std::uint64_t version, kind, flags, bytes;
};

TypeStart take_start(ByteReader& reader) {
  const std::uint64_t first = reader.number(1), flags = reader.number(3), bytes = reader.number(4);
  require_sound(first >> 4 >= 1 && first >> 4 <= 3, "a datatype is of an unknown version");
  require_sound(bytes > 0, "a datatype has no size");
  return {first >> 4, first & 15, flags, bytes};
}

/// HDF5 copies these bits from the value, wherever they are said to be.
void take_bits(ByteReader& reader, const TypeStart& type) {
  const std::uint64_t offset = reader.number(2), precision = reader.number(2);
  require_sound(precision > 0 && offset + precision <= saturating_product(8, type.bytes),
                "a number's bits lie outside of it");
}

/// Fields count from the value's first bit, not from its offset, as the n-bit filter's types do.
void take_real(ByteReader& reader, const TypeStart& type) {
  constexpr std::uint64_t most_exponent_bits = 63;  // HDF5 copies them into a number of 64
  take_bits(reader, type);
  const std::uint64_t bits = saturating_product(8, type.bytes), sign = type.flags >> 8 & 0xff,
                      exponent = reader.number(1), exponent_bits = reader.number(1), mantissa = reader.number(1),
                      mantissa_bits = reader.number(1);
  reader.take(4);  // the exponent's bias
  require_sound(sign < bits && exponent_bits > 0 && exponent_bits <= most_exponent_bits &&
                    exponent + exponent_bits <= bits && mantissa_bits > 0 && mantissa + mantissa_bits <= bits,
                "a number's bits lie outside of it");
}

/// Names are padded to eights before version 3.
void take_name(ByteReader& reader, std::uint64_t version) {
  const std::size_t letters = reader.rest().find('\0');
  if (letters == std::string_view::npos) throw NotKnownHere{};
  reader.take(version < 3 ? (letters + 8) / 8 * 8 : letters + 1);
}

std::size_t bytes_needed(std::uint64_t number) {
  std::size_t bytes = 1;
  while ((number >>= 8) != 0) ++bytes;
  return bytes;
}

/// Members of version 1 may be arrays by themselves.
std::uint64_t take_member_extents(ByteReader& reader) {
  constexpr std::uint64_t most_dimensions = 4, not_used = 3 + 4 + 4;
  const std::uint64_t dimensions = reader.number(1);
  require_sound(dimensions <= most_dimensions, "a compound's member has too many dimensions");
  reader.take(not_used);
  std::uint64_t elements = 1;
  for (std::uint64_t i = 0; i < most_dimensions; ++i) {
    const std::uint64_t extent = reader.number(4);
    if (i < dimensions) elements = saturating_product(elements, extent);
  }
  return elements;
}

void take_members(ByteReader& reader, const TypeStart& type, const Widths& widths, int depth) {
  const std::uint64_t members = type.flags & 0xffff;
  require_sound(members > 0, "a compound has no members");
  const std::size_t offset_bytes = type.version < 3 ? 4 : bytes_needed(type.bytes);
  for (std::uint64_t i = 0; i < members; ++i) {
    take_name(reader, type.version);
    const std::uint64_t offset = reader.number(offset_bytes);
    const std::uint64_t elements = type.version == 1 ? take_member_extents(reader) : 1;
    const std::uint64_t bytes = saturating_product(elements, take_sound_type(reader, widths, depth + 1));
    require_sound(offset <= type.bytes && bytes <= type.bytes - offset, "a compound's member lies outside of it");
  }
}

void take_enumeration(ByteReader& reader, const TypeStart& type, const Widths& widths, int depth) {
  const std::uint64_t members = type.flags & 0xffff, bytes = take_sound_type(reader, widths, depth + 1);
  require_sound(bytes == type.bytes, "an enumeration has another size than its numbers");
  for (std::uint64_t i = 0; i < members; ++i) take_name(reader, type.version);
  if (bytes > reader.rest().size()) throw NotKnownHere{};
  reader.take(static_cast<std::size_t>(members * bytes));
}

void take_array(ByteReader& reader, const TypeStart& type, const Widths& widths, int depth) {
  constexpr std::uint64_t most_dimensions = 32;
  const std::uint64_t dimensions = reader.number(1);
  require_sound(dimensions > 0 && dimensions <= most_dimensions, "an array has no or too many dimensions");
  if (type.version < 3) reader.take(3);
  std::uint64_t elements = 1;
  for (std::uint64_t i = 0; i < dimensions; ++i) elements = saturating_product(elements, reader.number(4));
  if (type.version < 3) reader.take(static_cast<std::size_t>(4 * dimensions));
  require_sound(saturating_product(elements, take_sound_type(reader, widths, depth + 1)) == type.bytes,
                "an array has another size than its elements");
}

}  // namespace

std::uint64_t take_sound_type(ByteReader& reader, const Widths& widths, int depth) {
  enum : std::uint64_t { whole, real, time, text, bits, opaque, compound, reference, enumeration, sequence, array };
  constexpr int deepest = 16;
  require_sound(depth < deepest, "a datatype is nested too deeply");
  const TypeStart type = take_start(reader);
  switch (type.kind) {
    case whole:
    case bits:
      take_bits(reader, type);
      break;
    case real:
      take_real(reader, type);
      break;
    case time:
      require_sound(reader.number(2) <= saturating_product(8, type.bytes), "a time's bits lie outside of it");
      break;
    case text:
      break;
    case opaque:
      reader.take(static_cast<std::size_t>(type.flags & 0xff));
      break;
    case compound:
      take_members(reader, type, widths, depth);
      break;
    case reference:
      require_sound((type.flags & 15) <= 1 && type.bytes == widths.address + ((type.flags & 15) == 1 ? 4 : 0),
                    "a reference has another size than an address");
      break;
    case enumeration:
      take_enumeration(reader, type, widths, depth);
      break;
    case sequence:  // HDF5 takes the size on disk for granted: a length, an address and an index
      require_sound(type.bytes == widths.address + 8, "a type of variable length has another size than on disk");
      take_sound_type(reader, widths, depth + 1);
      break;
    case array:
      take_array(reader, type, widths, depth);
      break;
    default:
      throw Unsound{"a datatype is of an unknown class"};
  }
  return type.bytes;
}

std::uint64_t take_sound_space(ByteReader& reader, const Widths& widths) {
  constexpr std::uint64_t most_dimensions = 32, largest_flag = 1, nothing = 2;
  const std::uint64_t version = reader.number(1), dimensions = reader.number(1), flags = reader.number(1),
                      kind = reader.number(1);
  require_sound(version == 1 || version == 2, "a dataspace is of an unknown version");
  require_sound(dimensions <= most_dimensions, "a dataspace has too many dimensions");
  if (version == 1) reader.take(4);
  std::uint64_t elements = 1;
  for (std::uint64_t i = 0; i < dimensions; ++i) elements = saturating_product(elements, reader.number(widths.size));
  if ((flags & largest_flag) != 0) reader.take(static_cast<std::size_t>(dimensions) * widths.size);
  return version == 2 && kind == nothing ? 0 : elements;
}

}  // namespace modebank::hdf5
