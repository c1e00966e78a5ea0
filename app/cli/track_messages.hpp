#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <string_view>

#include "ident/base/printable.hpp"
#include "io/files/standard_error.hpp"

namespace modebank::app {

/// What a live filter says beside its estimates. Never waits and never fails: what standard error does not take is
/// dropped, and counted for the next message that it takes.
class LiveMessages {
 public:
  void say(std::string_view text) {
    if (dropped_ > 0 && say_now(fmt::format("modebank: {} messages before this one were dropped\n", dropped_)))
      dropped_ = 0;
    if (dropped_ > 0 || !say_now(fmt::format("modebank: {}\n", printable(text)))) ++dropped_;
  }

 private:
  std::size_t dropped_ = 0;
};

}  // namespace modebank::app
