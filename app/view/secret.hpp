#pragma once

#include <string>
#include <string_view>

namespace modebank::app::view {

/// 128 bits of the kernel's random numbers, as 32 digits.
std::string random_secret();

/// In a time that does not depend on where they differ, so that nobody finds a secret digit by digit.
bool same_secret(std::string_view given, std::string_view secret);

}  // namespace modebank::app::view
