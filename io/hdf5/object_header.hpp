#pragma once

#include <hdf5.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace modebank::hdf5 {

/// What a file holds is not of the kinds that are read here: HDF5 itself has to read it, and to say what is wrong.
struct NotKnownHere {};

/// The bytes of a file that HDF5 has opened by our driver (file_driver.hpp), a window of them in memory.
class FileBytes {
 public:
  /// Throws NotKnownHere where another driver has the file. The file must outlive this.
  explicit FileBytes(hid_t object);
  /// `count` bytes at an address as HDF5 counts them, until the next call. Throws NotKnownHere where there are fewer.
  std::string_view at(haddr_t address, std::size_t count);

 private:
  int descriptor_ = -1;
  haddr_t base_ = 0;  ///< of HDF5's addresses: what precedes its content
  haddr_t first_ = 0;
  std::string window_;
};

/// Takes numbers as HDF5 lays them out, least significant byte first. Throws NotKnownHere at the end.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}
  std::uint64_t number(std::size_t bytes);
  std::string_view take(std::size_t count);
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

/// How an object header of version 1 (old) or 2 begins.
struct HeaderStart {
  bool is_old;
  bool ordered;         ///< messages have a number of their order
  std::uint64_t begin;  ///< of the messages of the first chunk
  std::uint64_t bytes;  ///< of these messages
  std::uint64_t all() const { return begin + bytes + (is_old ? 0 : 4); }
  std::size_t message_start_bytes() const { return is_old ? 8 : ordered ? 6 : 4; }
};
/// Enough of a header's bytes for that.
inline constexpr std::size_t longest_header_start = 34;

/// From the bytes at a header's address; none where they are no header's. Throws NotKnownHere where they end too early,
/// or it is of another version.
std::optional<HeaderStart> header_start(std::string_view bytes);

/// A message of an object header of any version.
struct RawMessage {
  std::uint64_t kind = 0;
  bool shared = false;  ///< it says where the message is
  std::string_view content;
};

/// Hands on the messages of a chunk; what is left at its end is less than a message's own header. Throws NotKnownHere
/// where one does not end in it.
void each_message(const HeaderStart& header, std::string_view messages,
                  const std::function<void(const RawMessage&)>& see);

/// One message of an object's header, of a kind that is known here.
struct HeaderMessage {
  enum class Kind : std::uint8_t {
    nothing = 0,
    dataspace = 1,
    link_info = 2,
    datatype = 3,
    fill_value = 5,
    link = 6,
    layout = 8,
    group_info = 10,
    attribute = 12,
    continuation = 16,
    attribute_info = 21
  };
  Kind kind;
  bool shared;  ///< it says where the message is
  std::string content;
};

/// All messages of an object header of version 2, as every object of an archive has; its checksums are looked at.
/// Throws NotKnownHere for all else.
std::vector<HeaderMessage> header_messages(FileBytes& file, haddr_t address);

}  // namespace modebank::hdf5
