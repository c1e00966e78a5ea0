#pragma once

#include <string>

#include "app/export/exported_bank.hpp"

/// The tables of a bank that filter.h and filter.c include.
namespace modebank::app::c_form {

/// Content of bank_sizes.h: sizes, and enumerations of signals and modes. `prefix`: first word of the enumerators, in
/// capitals.
std::string bank_sizes(const ExportedBank& bank, const std::string& prefix);
/// bank_numbers.h.
std::string bank_numbers(const ExportedBank& bank);

}  // namespace modebank::app::c_form
