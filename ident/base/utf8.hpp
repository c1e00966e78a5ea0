#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace modebank {

/// Bytes of the character of UTF-8 that a text, which is not empty, begins with; 0: its first byte begins none.
std::size_t character_bytes(std::string_view text);

/// Whether the bytes are text in UTF-8 (RFC 3629: no surrogates, nothing longer than needed, at most U+10FFFF).
bool is_utf8(std::string_view bytes);

/// The text in UTF-16 without surrogates. A byte that begins no character, and a character beyond U+FFFF, becomes
/// U+FFFD.
std::u16string basic_utf16(std::string_view text);

/// Appends a code point, of which 21 bits count.
void append_utf8(std::string& text, std::uint32_t code);

/// The text with every line that is not UTF-8 read as Windows-1252, as Excel and many loggers write it; the five bytes
/// that it does not define become the control characters of Latin-1. Text in UTF-8 comes back as it is, without a copy
/// (`storage` keeps any other). By lines, because a program may add to a file that another one began.
std::string_view utf8_or_windows_1252(std::string_view text, std::string& storage);

/// The line for people where any line was read so.
inline constexpr const char* read_as_windows_1252 = "bytes that are not UTF-8 are read as Windows-1252";

}  // namespace modebank
