// Logs that are text, formulas.
#include <cmath>
#include <limits>
#include <stdexcept>

#include "io/import/derived.hpp"
#include "tests/fuzz/mutate.hpp"
#include "tests/fuzz/read_table.hpp"
#include "tests/fuzz/scratch.hpp"
#include "tests/fuzz/target.hpp"

namespace modebank::fuzz {

namespace {

void read_csv(std::string_view text) {
  Random chances = chances_of(text);
  const std::filesystem::path file = scratch_file("fuzz.csv", text);
  if (chances.one_in(3))
    import_some(file, chances);
  else
    read_all_tables(file, chances);
}

/// Lines of data.derive; one that begins with "where " is data.where. Columns hold what logs hold.
void compute_channels(std::string_view text) {
  DataOptions options;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line(text.substr(begin, end - begin));
    if (line.starts_with("where "))
      options.where = line.substr(6);
    else if (!line.empty())
      options.derive.push_back(line);
    begin = end + 1;
  }
  const DerivedChannels channels(options);
  const double none = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> time_s{0.0, 0.1, 0.2, 0.2, 0.1, 1e9, 1e9};
  const std::vector<std::vector<double>> columns{
      {0.0, 1.0, -1.0, 0.5, 3.1, -3.1, 100.0}, {1e308, -1e308, none, 0.0, -0.0, 1e-320, 1e30}, {1, 1, 1, 1, 1, 1, 1}};
  const auto evaluate = [&](const DerivedChannel& channel) {
    std::vector<std::span<const double>> operands;
    for (std::size_t i = 0; i < channel.expression.channels().size(); ++i) operands.push_back(columns[i % 3]);
    for (const double value : channel.expression.evaluate(operands, time_s))
      if (std::isinf(value)) throw std::logic_error("a value is not finite");
  };
  for (const std::string& name : channels.names()) evaluate(*channels.find(name));
  if (channels.where()) evaluate(*channels.where());
}

const std::vector<std::string> csv_tokens{"time",
                                          "t",
                                          "timestamp",
                                          "sec",
                                          "nanosec",
                                          "x [m/s]",
                                          "\"a,b\"",
                                          "\"\"",
                                          "# time x",
                                          "%",
                                          "nan",
                                          "-",
                                          "NA",
                                          "1;2;3",
                                          "1,5",
                                          "1\t2",
                                          "|",
                                          "\r\n",
                                          "true",
                                          "2024-03-01 12:00:00.5",
                                          "1700000000.5",
                                          "1700000000500000000"};
const std::vector<std::string> formula_tokens{
    "diff(",  "unwrap(", "yaw(", "rotate_x(", "wrap(", "where ", "[m/s] = ", " = ",  "'",    "''",   "?",   ":",
    "&&",     "||",      "==",   "^",         "e",     "pi",     "_pi",      "sum(", "avg(", "min(", "if(", "mod(",
    "atan2(", "hypot(",  ",",    "1e400",     "0x",    "c0",     "c1",       "not(", "-",    "!",    "=",   ";"};

}  // namespace

std::vector<Target> table_targets() {
  constexpr std::uint64_t million = 1'000'000;
  return {{"csv", million,
           [](Random& random) {
             static const auto texts = corpus("csv");
             return mutated_text(random, texts, csv_tokens);
           },
           read_csv},
          {"formula", million,
           [](Random& random) {
             static const auto texts = corpus("formula");
             return mutated_text(random, texts, formula_tokens);
           },
           compute_channels}};
}

}  // namespace modebank::fuzz
