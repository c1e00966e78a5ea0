#include "tests/fuzz/mutate.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>

#include "tests/fuzz/target.hpp"

namespace modebank::fuzz {

namespace {

/// A stretch of `text`, between two places that `is_edge` takes for ends of something (or anywhere).
struct Stretch {
  std::size_t begin = 0, count = 0;
};

Stretch stretch_between(Random& random, std::string_view text, std::string_view edges) {
  if (text.empty()) return {};
  const std::size_t inside = random.below(text.size());
  const std::size_t before = text.substr(0, inside).find_last_of(edges);
  const std::size_t begin = before == std::string_view::npos ? 0 : before + 1;
  const std::size_t after = text.find_first_of(edges, inside);
  return {begin, (after == std::string_view::npos ? text.size() : after) - begin};
}

Stretch any_stretch(Random& random, std::string_view text, std::size_t longest) {
  const std::size_t begin = random.below(text.size() + 1);
  return {begin, std::min(random.below(longest) + 1, text.size() - begin)};
}

Stretch a_line(Random& random, std::string_view text) {
  Stretch line = stretch_between(random, text, "\n");
  if (line.begin + line.count < text.size()) ++line.count;
  return line;
}

Stretch a_number(Random& random, std::string_view text) {
  if (text.empty()) return {};
  const std::size_t at = text.find_first_of("0123456789", random.below(text.size()));
  if (at == std::string_view::npos) return {};
  const std::size_t end = text.find_first_not_of("0123456789.eE+-", at);
  return {at, (end == std::string_view::npos ? text.size() : end) - at};
}

constexpr std::string_view between_fields = ",;\t| \n=:\"[]{}().'/";

/// Text that separates, ends or begins something somewhere.
std::string odd_text(Random& random) {
  using namespace std::string_literals;
  return random.pick({""s,
                      "\n"s,
                      "\r\n"s,
                      "\r"s,
                      "\0"s,
                      "\""s,
                      "'"s,
                      ","s,
                      ";"s,
                      "\t"s,
                      "="s,
                      "#"s,
                      "{"s,
                      "}"s,
                      "["s,
                      "]"s,
                      "("s,
                      ")"s,
                      "\\"s,
                      "../"s,
                      "\xEF\xBB\xBF"s,
                      "\xFF\xFE"s,
                      "\xC3"s,
                      "\xF0\x9F\x98\x80"s,
                      "\x1b[2J"s,
                      "NaN"s,
                      "null"s,
                      "true"s,
                      std::string(1 + random.below(300), 'a'),
                      std::string(1 + random.below(120), '('),
                      std::string(1 + random.below(2000), '[')});
}

void change_once(Random& random, const std::vector<std::string>& corpus, const std::vector<std::string>& tokens,
                 std::string& text) {
  const auto token = [&] { return tokens.empty() ? odd_text(random) : random.pick(tokens); };
  switch (random.below(13)) {
    case 0: {  // a line cut
      const Stretch line = a_line(random, text);
      text.erase(line.begin, line.count);
      break;
    }
    case 1: {  // a line doubled, often
      const Stretch line = a_line(random, text);
      const std::string copy = text.substr(line.begin, line.count);
      for (std::size_t left = random.one_in(4) ? random.below(50) : 1; left > 0 && text.size() < most_bytes; --left)
        text.insert(line.begin, copy);
      break;
    }
    case 2: {  // a line moved
      const Stretch line = a_line(random, text);
      const std::string moved = text.substr(line.begin, line.count);
      text.erase(line.begin, line.count);
      text.insert(a_line(random, text).begin, moved);
      break;
    }
    case 3: {  // lines of another text
      const std::string& other = random.pick(corpus);
      const Stretch from = a_line(random, other);
      text.insert(a_line(random, text).begin, other.substr(from.begin, random.below(400)));
      break;
    }
    case 4: {  // a field by another one
      const Stretch to = stretch_between(random, text, between_fields);
      const Stretch from = stretch_between(random, text, between_fields);
      text.replace(to.begin, to.count, std::string(text, from.begin, from.count));
      break;
    }
    case 5: {  // a field by a word
      const Stretch field = stretch_between(random, text, between_fields);
      text.replace(field.begin, field.count, token());
      break;
    }
    case 6:  // a word somewhere
      text.insert(random.below(text.size() + 1), token());
      break;
    case 7:
    case 8: {  // a number
      const Stretch number = a_number(random, text);
      text.replace(number.begin, number.count, odd_number(random));
      break;
    }
    case 9:
      text.insert(random.below(text.size() + 1), odd_text(random));
      break;
    case 10: {
      const Stretch cut = any_stretch(random, text, 80);
      text.erase(cut.begin, cut.count);
      break;
    }
    case 11: {
      const Stretch copied = any_stretch(random, text, 200);
      text.insert(random.below(text.size() + 1), std::string(text, copied.begin, copied.count));
      break;
    }
    default:
      if (!text.empty()) text[random.below(text.size())] = static_cast<char>(random.next());
  }
}

/// `bytes` of a number, little-endian, at `at`, as far as there is room.
void put(std::string& content, std::size_t at, std::uint64_t value, unsigned bytes) {
  for (unsigned i = 0; i < bytes && at + i < content.size(); ++i) content[at + i] = static_cast<char>(value >> 8 * i);
}

std::uint64_t get(const std::string& content, std::size_t at, unsigned bytes) {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < bytes && at + i < content.size(); ++i)
    value |= std::uint64_t{static_cast<unsigned char>(content[at + i])} << 8 * i;
  return value;
}

/// A place most often among the first and the last bytes, where sizes and positions stand.
std::size_t a_place(Random& random, const std::string& bytes) {
  if (random.one_in(3)) return random.below(std::min<std::size_t>(bytes.size(), 512));
  if (random.one_in(3)) return bytes.size() - 1 - random.below(std::min<std::size_t>(bytes.size(), 2048));
  return random.below(bytes.size());
}

}  // namespace

std::uint64_t odd_whole(Random& random) {
  const unsigned bits = random.pick({7u, 8u, 15u, 16u, 31u, 32u, 63u, 64u});
  const std::uint64_t limit = bits == 64 ? 0 : std::uint64_t{1} << bits;
  switch (random.below(4)) {
    case 0:
      return random.below(8);
    case 1:
      return limit + random.below(3) - 1;
    case 2:
      return std::uint64_t{0} - random.below(8);
    default:
      return random.next() >> random.below(64);
  }
}

double odd_double(Random& random) {
  using Limits = std::numeric_limits<double>;
  if (random.one_in(3)) return std::bit_cast<double>(random.next());
  return random.pick({0.0,
                      -0.0,
                      1.0,
                      -1.0,
                      0.5,
                      2.0,
                      -0.1,
                      1e-12,
                      1e6,
                      1e15,
                      1e30,
                      -1e30,
                      1e100,
                      1e155,
                      1e300,
                      -1e300,
                      Limits::infinity(),
                      -Limits::infinity(),
                      Limits::quiet_NaN(),
                      Limits::max(),
                      Limits::min(),
                      Limits::denorm_min(),
                      9007199254740993.0,
                      9.3e18,
                      1.7e9,
                      1.7e18});
}

std::string odd_number(Random& random) {
  using namespace std::string_literals;
  if (random.one_in(3)) return std::to_string(static_cast<std::int64_t>(odd_whole(random)));
  if (random.one_in(3)) return std::to_string(odd_whole(random));
  return random.pick({"0"s,
                      "-0"s,
                      "1e308"s,
                      "-1e308"s,
                      "1e309"s,
                      "1e-400"s,
                      "4.9e-324"s,
                      "nan"s,
                      "-nan"s,
                      "inf"s,
                      "-inf"s,
                      "1e30"s,
                      "1e100"s,
                      "0x1p4"s,
                      "1,5"s,
                      "1.5.5"s,
                      "+1"s,
                      ".5"s,
                      "5."s,
                      "1e"s,
                      "--1"s,
                      "1700000000000000000"s,
                      "1700000000"s,
                      "18446744073709551616"s,
                      "99999999999999999999999999"s,
                      "0.1"s,
                      "1e6"s,
                      "1e9"s,
                      "-1"s,
                      "2024-02-30T25:61:61Z"s,
                      "2024-02-29T12:00:00.123456789+02:00"s,
                      std::string(1 + random.below(400), '9')});
}

std::string mutated_text(Random& random, const std::vector<std::string>& corpus,
                         const std::vector<std::string>& tokens) {
  if (corpus.empty()) throw std::logic_error("there is no corpus to mutate");
  std::string text = random.pick(corpus);
  std::size_t changes = 1;
  while (changes < 16 && !random.one_in(3)) ++changes;
  for (; changes > 0; --changes) change_once(random, corpus, tokens, text);
  if (text.size() > most_bytes) text.resize(most_bytes);
  return text;
}

std::string mutated_bytes(Random& random, std::string bytes) {
  std::size_t changes = 1;
  while (changes < 8 && !random.one_in(2)) ++changes;
  for (; changes > 0 && !bytes.empty(); --changes) {
    const std::size_t at = a_place(random, bytes);
    const unsigned width = random.pick({1u, 2u, 4u, 8u});
    switch (random.below(8)) {
      case 0:
        if (random.one_in(4)) bytes.resize(random.below(bytes.size()));
        break;
      case 1:
        std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), std::min(random.below(64), bytes.size() - at),
                    random.one_in(2) ? '\0' : '\xff');
        break;
      case 2:
        bytes.insert(at, std::string(bytes, at, random.below(256)));
        break;
      case 3:
        bytes.erase(at, random.below(32));
        break;
      case 4:
        put(bytes, at, odd_whole(random), width);
        break;
      case 5:
        put(bytes, at, get(bytes, at, width) + random.below(9) - 4, width);
        break;
      default:
        bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ 1u << random.below(8));
    }
  }
  return bytes;
}

}  // namespace modebank::fuzz
