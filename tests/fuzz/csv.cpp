// Reads text logs, both in the detected dialect and in stated dialects.
#include "tests/fuzz/entry.hpp"
#include "tests/fuzz/read_log.hpp"

namespace modebank::fuzz {

namespace {

/// The stated dialect depends on the input's length, so the same input always gets the same dialect.
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
