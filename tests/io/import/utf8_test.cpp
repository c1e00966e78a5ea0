// Bytes that are read as text. Each line is UTF-8 or Windows-1252. The expected characters are those of Python's
// codecs.
#include "ident/base/utf8.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace modebank {
namespace {

std::string converted(std::string_view text) {
  std::string storage;
  return std::string(utf8_or_windows_1252(text, storage));
}

TEST(Utf8, IsToldFromOtherBytes) {
  for (const char* text : {"", "plain, and longer than eight bytes", "größe", "wheel_µ 速度 \xF0\x9F\x9A\x97",
                           "\xED\x9F\xBF", "\xEE\x80\x80", "\xF4\x8F\xBF\xBF"})
    EXPECT_TRUE(is_utf8(text)) << text;
  // Invalid sequences by RFC 3629, sections 4 and 10: overlong forms, surrogates, values beyond U+10FFFF, truncated and
  // stray bytes.
  for (const char* text :
       {"gr\xF6\xDF"
        "e",
        "\xC0\x80", "\xC1\xBF", "\xE0\x9F\xBF", "\xF0\x8F\xBF\xBF", "\xED\xA0\x80", "\xED\xBF\xBF", "\xF4\x90\x80\x80",
        "\xF5\x80\x80\x80", "\xE2\x82", "\x80", "a long line of text, then \xFF"})
    EXPECT_FALSE(is_utf8(text));
}

TEST(Utf8, OtherBytesAreWindows1252) {
  std::string bytes;
  for (int byte = 0x80; byte < 0x100; ++byte)
    if (byte != 0x81 && byte != 0x8D && byte != 0x8F && byte != 0x90 && byte != 0x9D) bytes += static_cast<char>(byte);
  EXPECT_EQ(converted(bytes),
            "€‚ƒ„…†‡ˆ‰Š‹ŒŽ‘’“”•–—˜™š›œžŸ ¡¢£¤¥¦§¨©ª«¬­®¯°±²³´µ¶·¸¹º»¼½¾¿ÀÁÂÃÄÅÆÇÈÉÊËÌÍÎÏÐÑÒÓÔÕÖ×ØÙÚÛÜÝÞßàáâãäåæçèéêëìíî"
            "ïðñòóôõö÷øùúûüýþÿ");
  EXPECT_EQ(converted("gr\xF6\xDF"
                      "e"),
            "größe");
  EXPECT_EQ(converted("\x81"), "\xC2\x81") << "one of the five that it does not define";
}

TEST(Utf8, EachLineHasItsOwn) {
  EXPECT_EQ(converted("größe\n20 \xB0"
                      "C\n20 °C\n\xF6"),
            "größe\n20 °C\n20 °C\nö");
  const std::string plain = "größe\n1\n";
  std::string storage;
  EXPECT_EQ(utf8_or_windows_1252(plain, storage).data(), plain.data()) << "without a copy";
}

}  // namespace
}  // namespace modebank
