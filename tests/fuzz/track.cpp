// Reads lines of samples, the input of `track`.
#include <cmath>

#include "app/cli/track_input.hpp"
#include "tests/fuzz/entry.hpp"
#include "tests/io/archive/archive_fixture.hpp"

namespace modebank::fuzz {

namespace {

/// A bank of three modes with one state and one input.
BankFilter new_filter() {
  static const Bank bank = *test::full_archive(1, 1).bank;
  return {bank, {}};
}

void track_lines(std::string_view text) {
  DataOptions columns;
  columns.input = {"u0"};
  columns.state = {"x0"};
  app::SampleReader reader(columns);
  BankFilter filter = new_filter();
  double last_s = -INFINITY;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line(text.substr(begin, end - begin));
    reader.read({&line, 1}, [&](std::size_t, app::SampleReader::Line kind) {
      const app::TimedSample& sample = reader.sample();
      if (kind != app::SampleReader::Line::sample || !(sample.time_s > last_s)) return;
      last_s = sample.time_s;
      filter.step(sample.time_s, sample.input, sample.measurement);
    });
    begin = end + 1;
  }
}

const Entry track("track", track_lines);

}  // namespace

}  // namespace modebank::fuzz
