#pragma once

#include <string>

namespace modebank::app {

/// When a user should touch a key, without a full stop ("when the log has no units", "never, unless ..."); empty for
/// what is no key.
std::string when_to_touch(const std::string& key);

}  // namespace modebank::app
