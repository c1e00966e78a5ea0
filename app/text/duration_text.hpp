#pragma once

#include <string>

namespace modebank::app {

/// "3 s", "4.2 min", "1.5 h".
std::string duration_text(double seconds);

/// "12.3 per s", "40 per h".
std::string rate_text(double per_second);

}  // namespace modebank::app
