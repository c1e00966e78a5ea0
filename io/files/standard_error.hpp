#pragma once

#include <string_view>

namespace modebank {

/// Writes text to standard error and drops what it does not take, so that a full or closed log does not stop the
/// program. Returns false when something was dropped.
bool say(std::string_view text);

/// The same without waiting: text for which the reader has no room is dropped.
bool say_now(std::string_view text);

/// Opens closed standard streams such that their use fails as before. Otherwise a file opened later would get their
/// numbers, and messages would go into it. Call it before any file is opened.
void occupy_standard_streams();

}  // namespace modebank
