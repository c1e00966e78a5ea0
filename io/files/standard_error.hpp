#pragma once

#include <string_view>

namespace modebank {

/// Writes to standard error what it takes; the rest is dropped: a log that is full or closed is no reason to stop.
/// False when something was dropped.
bool say(std::string_view text);

/// The same, but never waits for a reader that does not read: what would have to wait is dropped.
bool say_now(std::string_view text);

/// Opens what was closed of standard input, output and error so that it fails as before, but no file that is opened
/// later gets its number, and messages in it. To be called before any file is opened.
void occupy_standard_streams();

}  // namespace modebank
