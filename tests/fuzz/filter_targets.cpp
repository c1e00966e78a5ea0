// What `track` reads: lines of samples, and checkpoints.
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>

#include "app/cli/live_filter.hpp"
#include "app/cli/track_input.hpp"
#include "app/config/config_file.hpp"
#include "io/archive/array_json.hpp"
#include "io/archive/filter_checkpoint.hpp"
#include "modebank/base/error.hpp"
#include "tests/fuzz/mutate.hpp"
#include "tests/fuzz/read_table.hpp"
#include "tests/fuzz/scratch.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/io/archive/archive_fixture.hpp"

namespace modebank::fuzz {

namespace {

constexpr const char* identity = "fuzz";

/// A bank of three modes with one state and one input, and the ways to run it.
BankFilter new_filter(std::size_t way) {
  static const Bank bank = *test::full_archive(1, 1).bank;
  FilterOptions options;
  options.noise = way % 2 == 0 ? FilterNoise::gaussian : FilterNoise::adaptive;
  options.variant = way / 2 % 2 == 0 ? FilterVariant::imm : FilterVariant::mmae;
  return {bank, options};
}

/// Nothing that a filter says of finite samples may be infinite.
void check_estimate(const FilterEstimate& estimate) {
  if (!estimate.state.allFinite() || !estimate.mode_probability.allFinite())
    throw std::logic_error("the filter gives numbers that are not finite");
}

/// The columns of that bank.
DataOptions columns() {
  DataOptions data;
  data.input = {"u0"};
  data.state = {"x0"};
  return data;
}

void track_lines(std::string_view text) {
  Random chances = chances_of(text);
  const auto format = chances.pick(
      {app::LineFormat::automatic, app::LineFormat::automatic, app::LineFormat::csv, app::LineFormat::ndjson});
  app::SampleReader reader(columns(), format);
  BankFilter filter = new_filter(chances.below(4));
  double last_s = -INFINITY;
  std::vector<std::string> lines;
  const auto read = [&] {
    reader.read(lines, [&](std::size_t, app::SampleReader::Line kind) {
      const TimedSample& sample = reader.sample();
      if (kind != app::SampleReader::Line::sample || !(sample.time_s > last_s)) return;
      last_s = sample.time_s;
      filter.step(sample.time_s, sample.input, sample.measurement);
    });
    lines.clear();
  };
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.emplace_back(text.substr(begin, end - begin));
    if (chances.below(2) == 0) read();
    begin = end + 1;
  }
  read();
}

/// Goes on from a checkpoint as `track` does, for a few samples.
void resume(const std::filesystem::path& file, std::size_t way) {
  BankFilter filter = new_filter(way);
  try {
    filter.restore(load_checkpoint(file, identity));
  } catch (const std::invalid_argument& error) {
    throw DataError(error.what());
  }
  for (int k = 0; k < 4; ++k) {
    const FilterEstimate& estimate =
        filter.step(NAN, Eigen::VectorXd::Constant(1, 0.1), Eigen::VectorXd::Constant(1, 0.2));
    if (filter.started()) check_estimate(estimate);
  }
}

std::vector<std::string> checkpoints() {
  std::vector<std::string> texts;
  for (std::size_t way = 0; way < 4; ++way) {
    BankFilter filter = new_filter(way);
    for (int k = 0; k < 5; ++k)
      filter.step(0.1 * k, Eigen::VectorXd::Constant(1, 0.1 * k), Eigen::VectorXd::Constant(1, 0.2));
    save_checkpoint(scratch("seed.json"), identity, filter.snapshot());
    texts.push_back(content_of(scratch("seed.json")));
  }
  return texts;
}

void read_checkpoint(std::string_view text) { resume(scratch_file("fuzz.json", text), chances_of(text).below(4)); }

/// JSON wherever it comes from outside: a line of samples, a text of an archive, a checkpoint. Each reader sees every
/// text; taken is what one of them takes.
void read_json(std::string_view text) {
  const std::function<void()> readers[] = {
      [&] {
        app::SampleReader(columns(), app::LineFormat::ndjson)
            .read({std::string(text)}, [](std::size_t, app::SampleReader::Line) {});
      },
      [&] { hdf5::text_json(std::string(text)).dump(); }, [&] { read_checkpoint(text); }};
  std::optional<DataError> refusal;
  bool taken = false;
  for (const auto& read : readers) try {
      read();
      taken = true;
    } catch (const DataError& error) {
      refusal = error;
    }
  if (!taken && refusal) throw *refusal;
}

const std::vector<std::string> json_tokens{
    "\"time\":",    "\"u0\":",     "\"x0\":",     "null",    "NaN",   "-Infinity", "true",
    "{}",           "[]",          "\"\\ud800\"", "\\u0000", "1e999", "-0",        "\"rows\":",
    "\"columns\":", "\"format\":", "time,u0,x0",  "time",    "u0",    "x0",        ","};

}  // namespace

std::vector<Target> filter_targets() {
  constexpr std::uint64_t million = 1'000'000;
  return {{"track", million,
           [](Random& random) {
             static const auto texts = corpus("track");
             return mutated_text(random, texts, json_tokens);
           },
           track_lines},
          {"checkpoint", million,
           [](Random& random) {
             static const auto texts = checkpoints();
             return mutated_text(random, texts, json_tokens);
           },
           read_checkpoint},
          {"json", million,
           [](Random& random) {
             static const auto texts = corpus("json");
             return mutated_text(random, texts, json_tokens);
           },
           read_json}};
}

}  // namespace modebank::fuzz
