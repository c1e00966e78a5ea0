#pragma once

#include <string_view>

/// Contents of filter.h and filter.c in this folder.
namespace modebank::app::assets {

std::string_view filter_h();
std::string_view filter_c();

}  // namespace modebank::app::assets
