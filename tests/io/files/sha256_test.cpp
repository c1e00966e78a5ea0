#include "io/files/sha256.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "io/files/sha256_blocks.hpp"
#include "tests/support/golden.hpp"

namespace modebank {
namespace {

// Examples of FIPS 180-4 (NIST, "Cryptographic Standards and Guidelines: example values", SHA-256) and the long message
// of FIPS 180-2, appendix B.3.
TEST(Sha256, OfTheEmptyMessage) {
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Sha256, OfOneBlock) {
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Sha256, OfTwoBlocks) {
  EXPECT_EQ(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST(Sha256, Of896Bits) {
  EXPECT_EQ(
      sha256_hex("abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmnhijklmnoijklmnopjklmnopqklmnopqrlmnopqrsmno"
                 "pqrstnopqrstu"),
      "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1");
}

TEST(Sha256, OfAMillionBytesInPieces) {
  Sha256 hash;
  const std::string piece(333, 'a');
  for (int i = 0; i < 3003; ++i) hash.update(piece);
  hash.update(std::string(1, 'a'));
  EXPECT_EQ(hash.hex(), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, GoesOnAfterAsking) {
  Sha256 hash;
  hash.update("ab");
  EXPECT_EQ(hash.hex(), sha256_hex("ab"));
  hash.update("c");
  EXPECT_EQ(hash.hex(), sha256_hex("abc"));
}

TEST(Sha256, OfEveryLengthAroundABlockInOneOrTwoPieces) {
  const nlohmann::json expected = test::read_golden("sha256").at("messages");
  for (std::size_t length = 0; length < expected.size(); ++length) {
    std::string message(length, '\0');
    for (std::size_t i = 0; i < length; ++i) message[i] = static_cast<char>((7 * i + length) % 256);
    Sha256 hash;
    hash.update(message.substr(0, length / 3));
    hash.update(message.substr(length / 3));
    const auto sum = expected[length].get<std::string>();
    EXPECT_EQ(hash.hex(), sum) << length;
    EXPECT_EQ(sha256_hex(message), sum) << length;
  }
}

std::string bytes_of(const std::string& hex) {
  std::string bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2) bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return bytes;
}

TEST(Sha256, PassesNistsMonteCarloTest) {
  const nlohmann::json golden = test::read_golden("sha256");
  std::string seed = bytes_of(golden.at("seed"));
  for (const nlohmann::json& expected : golden.at("monte_carlo")) {
    std::string a = seed, b = seed, c = seed;
    for (int i = 0; i < 1000; ++i) {
      std::string next = bytes_of(sha256_hex(a + b + c));
      a = std::move(b), b = std::move(c), c = std::move(next);
    }
    seed = c;
    ASSERT_EQ(bytes_of(expected), seed);
  }
}

TEST(Sha256, EquationsAndInstructionsAgree) {
  std::string blocks(37 * Sha256::block_bytes, '\0');
  for (std::size_t i = 0; i < blocks.size(); ++i) blocks[i] = static_cast<char>(i * i / 5 + 31 * i);
  const auto* bytes = reinterpret_cast<const unsigned char*>(blocks.data());
  Sha256::State by_equations{1, 2, 3, 4, 5, 6, 7, 0xffffffff}, by_instructions = by_equations;
  if (!sha256::compress_by_instructions(by_instructions, bytes, 37))
    GTEST_SKIP() << "this processor has no SHA-256 instructions";
  sha256::compress_by_equations(by_equations, bytes, 37);
  EXPECT_EQ(by_equations, by_instructions);
}

}  // namespace
}  // namespace modebank
