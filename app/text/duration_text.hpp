#pragma once

#include <string>

namespace modebank::app {

/// A duration such as "3 s", "4.2 min" or "1.5 h".
std::string duration_text(double seconds);

/// A rate such as "12.3 per s" or "40 per h".
std::string rate_text(double per_second);

/// A text with samples for seconds if the log has no times, because the rate of its samples is then invented.
/// `config`: the archive's configuration.
std::string in_samples(const std::string& config, const std::string& text);

}  // namespace modebank::app
