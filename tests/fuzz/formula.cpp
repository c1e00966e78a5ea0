// Reads expressions of data.derive and data.where.
#include <cmath>
#include <limits>

#include "io/import/derived.hpp"
#include "tests/fuzz/entry.hpp"

namespace modebank::fuzz {

namespace {

/// The input contains lines of data.derive. A line that begins with "where " is data.where. Columns contain typical
/// values of logs.
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
      require(!std::isinf(value), "a value is infinite");
  };
  for (const std::string& name : channels.names()) evaluate(*channels.find(name));
  if (channels.where()) evaluate(*channels.where());
}

const Entry formula("formula", compute_channels);

}  // namespace

}  // namespace modebank::fuzz
