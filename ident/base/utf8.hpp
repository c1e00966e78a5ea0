#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace modebank {

/// Length in bytes of the UTF-8 character at the start of a non-empty text; 0 if its first byte starts no character.
std::size_t character_bytes(std::string_view text);

/// Whether the bytes are valid UTF-8 (RFC 3629: no surrogates, no overlong forms, at most U+10FFFF).
bool is_utf8(std::string_view bytes);

/// Appends a code point; only its lowest 21 bits are used.
void append_utf8(std::string& text, std::uint32_t code);

/// Decodes every line that is not UTF-8 as Windows-1252, the encoding of Excel and many loggers. The five bytes that
/// Windows-1252 leaves undefined become Latin-1 control characters. Each line is tested separately, because two
/// programs may have written one file. Returns valid UTF-8 without a copy; any other text is stored in `storage`.
std::string_view utf8_or_windows_1252(std::string_view text, std::string& storage);

/// Message for users about lines that were decoded as Windows-1252.
inline constexpr const char* read_as_windows_1252 = "bytes that are not UTF-8 are read as Windows-1252";

}  // namespace modebank
