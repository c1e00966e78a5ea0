#pragma once

#include <string_view>

/// filter.h and filter.c as they stand in this folder.
namespace modebank::app::assets {

std::string_view filter_h();
std::string_view filter_c();

}  // namespace modebank::app::assets
