#pragma once

#include <cstddef>
#include <string_view>

/// Defines `std::string_view modebank::app::assets::NAME()` as the content of a file. The assembler copies the file
/// into the program, so that no compiler has to parse it.
#define MODEBANK_ASSET(name, file)                                                                                 \
  __asm__(".section .rodata\n.global modebank_asset_" #name "\nmodebank_asset_" #name ":\n.incbin \"" file         \
          "\"\n.global modebank_asset_" #name "_end\nmodebank_asset_" #name "_end:\n.byte 0\n.previous\n");        \
  extern "C" const char modebank_asset_##name[], modebank_asset_##name##_end[];                                    \
  std::string_view modebank::app::assets::name() {                                                                 \
    return {modebank_asset_##name, static_cast<std::size_t>(modebank_asset_##name##_end - modebank_asset_##name)}; \
  }
