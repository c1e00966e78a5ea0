#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "ident/base/characters.hpp"
#include "ident/base/printable.hpp"
#include "io/files/standard_error.hpp"

namespace modebank::app {

/// Messages of a live filter on standard error. Printing never blocks and never fails. A message that standard error
/// does not accept is dropped. The next message states how many were dropped.
class LiveMessages {
 public:
  void say(std::string_view text) {
    if (dropped_ > 0 && say_now(fmt::format("modebank: {} messages before this one were dropped\n", dropped_)))
      dropped_ = 0;
    if (dropped_ > 0 || !say_now(fmt::format("modebank: {}\n", printable(text)))) ++dropped_;
  }
  /// Prints only the first message of a kind. Messages of one kind differ only in numbers and quoted words.
  void say_once(const std::string& place, const std::string& text) {
    Repeats& repeats = repeats_[kind_of(text)];
    if (repeats.count++ == 0) {
      repeats.first = place;
      say(fmt::format("{}: {}", place, text));
    }
    repeats.last = place;
  }
  /// Prints remarks on the stream, each only once. Repetitions are not counted.
  void say_note(const std::string& place, const std::string& text) {
    if (notes_.insert(text).second) say(fmt::format("{}: {}", place, text));
  }
  /// Prints how often each message of say_once was repeated.
  void say_repeats() {
    for (const auto& [kind, repeats] : repeats_)
      if (repeats.count > 1)
        say(fmt::format("{}: this message was repeated {} time{}, last at {}", repeats.first, repeats.count - 1,
                        repeats.count == 2 ? "" : "s", repeats.last));
    repeats_.clear();
  }

 private:
  struct Repeats {
    std::size_t count = 0;
    std::string first, last;  ///< positions of the first and the last message in the input
  };
  std::size_t dropped_ = 0;
  std::map<std::string, Repeats> repeats_;
  std::set<std::string> notes_;

  static std::string kind_of(const std::string& text) {
    std::string kind;
    bool quoted = false;
    for (const char c : text) {
      if (c == '"') quoted = !quoted;
      if (!quoted && !is_digit(c) && c != '.' && c != '-' && c != '+') kind += c;
    }
    return kind;
  }
};

}  // namespace modebank::app
