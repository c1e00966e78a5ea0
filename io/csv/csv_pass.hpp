#pragma once

#include <csv.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <new>
#include <string_view>

#include "modebank/base/error.hpp"

namespace modebank {

/// One pass of libcsv over a text. It counts lines, passes fields and rows to `Sink`, and stops at the sink's first
/// error. Exceptions must not cross libcsv's C frames, so errors are stored until the pass ends. A Sink has
/// - void field(std::string_view), void row() (also called for empty lines) and bool done();
/// - the members `fields` (number of fields in this row so far), `line` (start of the row) and `error` (empty: no
/// error).
template <class Sink>
class CsvPass {
 public:
  /// `first_line`: number of the text's first line in the file.
  CsvPass(std::string_view file, Sink& sink, char delimiter, std::uint64_t first_line)
      : file_(file), sink_(sink), line_(first_line) {
    csv_init(&parser_, CSV_STRICT | CSV_STRICT_FINI | CSV_REPALL_NL);
    csv_set_delim(&parser_, static_cast<unsigned char>(delimiter));
  }
  ~CsvPass() { csv_free(&parser_); }
  CsvPass(const CsvPass&) = delete;
  CsvPass& operator=(const CsvPass&) = delete;

  void feed(std::string_view text) {
    while (!text.empty() && !sink_.done()) {
      const std::string_view chunk = text.substr(0, chunk_bytes);
      const std::size_t parsed = csv_parse(&parser_, chunk.data(), chunk.size(), on_field, on_row, this);
      check_sink();
      if (parsed != chunk.size() && !sink_.done()) fail_parser();
      text.remove_prefix(chunk.size());
    }
  }

  void finish() {
    if (sink_.done()) return;
    const int failed = csv_fini(&parser_, on_field, on_row, this);
    check_sink();
    if (failed != 0) fail_parser();
  }

 private:
  static CsvPass& self(void* pass) { return *static_cast<CsvPass*>(pass); }
  static void on_field(void* text, std::size_t bytes, void* pass) {
    self(pass).field({static_cast<const char*>(text), bytes});
  }
  static void on_row(int terminator, void* pass) { self(pass).row(terminator); }

  void field(std::string_view text) {
    if (sink_.done()) return;  // libcsv parses to the end of its chunk
    if (sink_.fields == 0) sink_.line = line_;
    after_return_ = false;
    sink_.field(text);
    if (text.find('\n') != std::string_view::npos)
      line_ += static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n'));
  }

  /// libcsv reports both bytes of CRLF. The second byte does not end a line again.
  void row(int terminator) {
    if (sink_.done()) return;
    const bool second_byte = terminator == CSV_LF && after_return_ && sink_.fields == 0;
    after_return_ = terminator == CSV_CR;
    if (second_byte) return;
    if (sink_.fields == 0) sink_.line = line_;
    sink_.row();
    sink_.fields = 0;
    ++line_;
  }

  void check_sink() const {
    if (!sink_.error.empty()) throw DataError(fmt::format("{}:{}: {}", file_, sink_.line, sink_.error));
  }

  [[noreturn]] void fail_parser() {
    if (csv_error(&parser_) == CSV_ENOMEM) throw std::bad_alloc();
    throw DataError(
        fmt::format("{}:{}: malformed quotes: a quoted field must end before the next separator", file_, line_));
  }

  static constexpr std::size_t chunk_bytes =
      1 << 18;  // bytes that are parsed before the sink is asked again whether it is done

  std::string_view file_;
  Sink& sink_;
  csv_parser parser_{};
  std::uint64_t line_;
  bool after_return_ = false;
};

}  // namespace modebank
