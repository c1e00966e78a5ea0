// Text logs, in the detected dialect and in stated ones.
#include "tests/fuzz/entry.hpp"
#include "tests/fuzz/read_log.hpp"

namespace modebank::fuzz {

namespace {

/// The length of the input selects the stated dialect, so that an input always has the same one.
void read_csv(std::string_view text) {
  const std::filesystem::path file = scratch_file("fuzz.csv", text);
  FormatOptions format;
  switch (text.size() % 4) {
    case 0:
      format.separator = Separator::semicolon;
      format.decimal = DecimalMark::comma;
      break;
    case 1:
      format.header = HeaderRow::no;
      break;
    case 2:
      format.separator = Separator::blank;
      break;
    default:
      break;
  }
  read_log(file, format, text.size() / 4);
}

const Entry csv("csv", read_csv);

}  // namespace

}  // namespace modebank::fuzz
