// Lines of standard input for a live filter.
#include "app/cli/tracker.hpp"

namespace modebank::app {

void Tracker::follow_lines() {
  constexpr std::size_t most_at_once = 512;
  const double lag_s = alignment_.lag_s;
  if (lag_s < 0.0)
    messages_.say(fmt::format(
        "inputs come {:.3g} s after the states that they act on. Each estimate waits for its input, but carries the "
        "time stamp of its sample",
        -lag_s));
  if (lag_s > 0.0)
    messages_.say(fmt::format("inputs come {:.3g} s before the states that they act on: they are held back", lag_s));
  lines_.emplace();
  std::vector<std::string> batch;
  std::string_view line;
  for (auto got = lines_->next(line); got != LineStream::Got::end; got = lines_->next(line)) {
    if (got == LineStream::Got::line && lines_->is_unended()) {
      const std::string last(line);
      take_lines(batch);
      take_last_line(last);
      continue;
    }
    if (got == LineStream::Got::line) batch.emplace_back(line);
    if (got == LineStream::Got::line && batch.size() < most_at_once) continue;
    take_lines(batch);
    if (got == LineStream::Got::waiting && !flush()) break;
    if (got != LineStream::Got::overlong) continue;
    place_ = fmt::format("line {}", ++line_number_);
    complain("is too long for a sample");
  }
  take_lines(batch);
  if (lines_->was_cut())
    messages_.say(fmt::format("line {}: the input was stopped inside this line, which is left out", line_number_ + 1));
}

void Tracker::take_lines(std::vector<std::string>& lines) {
  if (lines.empty()) return;
  reader_.read(lines, [&](std::size_t position, SampleReader::Line kind) {
    place_ = fmt::format("line {}", line_number_ + position + 1);
    take(kind);
  });
  line_number_ += lines.size();
  lines.clear();
}

/// The last line may be incomplete, because the writing program may have stopped inside it.
void Tracker::take_last_line(const std::string& line) {
  const bool whole = reader_.table().is_open() && reader_.table().is_whole(line);
  messages_.say(fmt::format("line {}: the last line has no line break at its end: {}", line_number_ + 1,
                            whole ? "it has all its fields and is used" : "fields are missing, so it is left out"));
  std::vector<std::string> last{line};
  if (whole) take_lines(last);
}

void Tracker::take(SampleReader::Line kind) {
  for (const std::string& note : reader_.table().notes()) messages_.say_note("standard input", note);
  if (kind == SampleReader::Line::blank) return;
  if (kind == SampleReader::Line::malformed) return complain(reader_.reason());
  if (!writer_) open_writer({config_.track.json || reader_.table().has_objects(), false});
  if (kind == SampleReader::Line::left_out) return complain("data.where is false");
  if (kind != SampleReader::Line::sample) return;
  if (const auto first_s = reader_.table().corrected_first_s()) correct_first(*first_s);
  for (const std::string& remark : reader_.remarks()) messages_.say_once(place_, remark);
  take_sample(reader_.sample());
}

}  // namespace modebank::app
