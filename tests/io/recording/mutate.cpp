#include "tests/io/recording/mutate.hpp"

#include <algorithm>
#include <random>

#include "io/recording/ros_log.hpp"
#include "modebank/base/error.hpp"
#include "tests/support/paths.hpp"

namespace modebank::test {

namespace {

LogWant::Form form_of(MessageColumn::Form form) {
  return form == MessageColumn::Form::text ? LogWant::Form::text : LogWant::Form::number;
}

}  // namespace

ReadOutcome read_everything(const std::filesystem::path& path) {
  ReadOutcome outcome;
  try {
    const RosLog log(path, KnownDefinitions());
    std::vector<LogRequest> requests;
    for (std::size_t t = 0; t < log.topics().size(); ++t) {
      if (!log.topics()[t].problem.empty()) continue;
      LogRequest& request = requests.emplace_back(LogRequest{t, {}});
      for (const MessageColumn& column : log.topics()[t].columns)
        request.columns.push_back({column.path, form_of(column.form)});
    }
    std::vector<std::string> notes;
    for (const LogRows& rows : log.read(requests, notes)) outcome.rows += rows.message.size();
  } catch (const ConfigurationError&) {
    outcome.refused = true;
  } catch (const DataError&) {
    outcome.refused = true;
  }
  return outcome;
}

ReadOutcome read_bytes_as_recording(std::string_view bytes, const std::filesystem::path& scratch) {
  write_file(scratch, std::string(bytes));
  return read_everything(scratch);
}

std::string mutated(std::string_view content, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto below = [&](std::size_t end) {
    return static_cast<std::size_t>(random() % std::max<std::size_t>(end, 1));
  };
  std::string bytes(content);
  switch (random() % 8) {
    case 0:  // cut off
      bytes.resize(below(bytes.size()));
      break;
    case 1: {  // a stretch blanked
      const std::size_t at = below(bytes.size()), count = std::min(below(64), bytes.size() - at);
      std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), count, random() % 2 == 0 ? '\0' : '\xff');
      break;
    }
    case 2: {  // a stretch doubled
      const std::size_t at = below(bytes.size()), count = std::min(below(256), bytes.size() - at);
      bytes.insert(at, bytes.substr(at, count));
      break;
    }
    default: {  // bits flipped, most often among the first and last bytes, where sizes and positions stand
      for (std::size_t flips = 1 + below(4); flips > 0 && !bytes.empty(); --flips) {
        std::size_t at = below(bytes.size());
        if (random() % 3 == 0) at = below(std::min<std::size_t>(bytes.size(), 512));
        if (random() % 3 == 0) at = bytes.size() - 1 - below(std::min<std::size_t>(bytes.size(), 2048));
        bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ 1u << random() % 8);
      }
    }
  }
  return bytes;
}

}  // namespace modebank::test
