#pragma once

#include <Eigen/Core>
#include <string>

#include "app/export/exported_bank.hpp"

/// The parts of an exported C program. In their texts $p stands for the prefix of all identifiers, $P for it in
/// capitals, $real for the type of numbers, $f for the suffix of math.h's functions and $F for that of constants.
namespace modebank::app::c_form {

struct Style {
  std::string prefix;
  bool single_precision = false;
};

/// For a comment of the program: the marks of the style mean nothing in it.
std::string c_comment(const std::string& text);

/// A comment that opens a file: the verdict first, where the bank comes from, and what it is.
std::string opening(const ExportedBank& bank, const char* what);
std::string header(const ExportedBank& bank, const std::string& prefix);
/// The bank's numbers.
std::string data(const ExportedBank& bank);
/// Sizes and bounds that the program's text is written with.
std::string constants(const ExportedBank& bank, bool single_precision);
/// The filter, as far as this bank needs it.
std::string program(const ExportedBank& bank);

}  // namespace modebank::app::c_form
