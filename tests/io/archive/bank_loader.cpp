// bank_loader ARCHIVE: links only the code that a robot needs to load a bank.
#include <cstdio>
#include <exception>

#include "io/archive/bank/load_bank.hpp"

int main(int argc, char** argv) try {
  if (argc < 2) return std::fprintf(stderr, "usage: bank_loader ARCHIVE\n"), 2;
  std::printf("%ld modes\n", static_cast<long>(modebank::load_bank(argv[1]).mode_count()));
  return 0;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "bank_loader: %s\n", error.what()), 1;
}
