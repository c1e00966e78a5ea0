#include "app/init/together.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/init/words.hpp"
#include "io/arrays/array_reader.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// A group per recording (demo_3), or a struct per recording (log[3]). Instruments of one robot have numbers, too.
void refuse_one_of_many(const SurveyedFile& file, const SurveyedTable& of) {
  const auto without_digits = [](std::string name) {
    std::erase_if(name, [](char c) { return c >= '0' && c <= '9'; });
    return name;
  };
  const std::string name = without_digits(of.name), path = file.path.string();
  const auto alike = std::count_if(file.tables.begin(), file.tables.end(), [&](const SurveyedTable& other) {
    return without_digits(other.name) == name && other.channels.size() == of.channels.size();
  });
  const std::string numbered = of.name.substr(0, of.name.find_last_of("0123456789") + 1),
                    word = without_digits(numbered);
  const bool structs = word.ends_with('[');
  const std::size_t end = structs ? word.size() - 1 : numbered.find_last_of('.');
  const std::string within = end == std::string::npos ? "/" : numbered.substr(0, end);
  const bool recordings = structs || names_run(word) || words_of_name(word).ends_with(" demo ");
  if (!of.type.empty() || numbered.empty() || !recordings || alike < 2) return;
  const std::string each =
      is_hdf5(file.path)
          ? fmt::format(
                "import h5py, numpy as np\nfor k, g in h5py.File('{}')['{}'].items():\n    c = {{}}\n    "
                "g.visititems(lambda n, d: c.update({{n: d[()]}} if hasattr(d, 'shape') else {{}}))",
                path, within)
          : fmt::format(
                "import scipy.io, numpy as np\nfor k, c in enumerate(scipy.io.loadmat('{}', "
                "simplify_cells=True)['{}']):",
                path, within);
  throw DataError(fmt::format(
      "{}: {} is one of {} recordings of the same columns, and a file is one recording; write a file of each:\npython3 "
      "-c \"{}\n    c = {{n: np.reshape(v, (len(v), -1)) for n, v in c.items() if np.ndim(v)}}\n    c = {{n: v for n, "
      "v "
      "in c.items() if len(v) == max(map(len, c.values()))}}\n    np.savetxt(f'run_{{k}}.csv', "
      "np.hstack(list(c.values())), delimiter=',', comments='', header=','.join(f'{{n}}_{{j}}' for n, v in c.items() "
      "for j in range(v.shape[1])))\"",
      path, of.name, alike, each));
}

/// If the input's robot has a table of the same kind as the state's, it is another robot.
void refuse_other_robot(const SurveyedFile& file, const SurveyedTable& state, const std::string& input) {
  const auto robot = [](const std::string& topic) { return topic.substr(0, topic.find('/', 1)); };
  const std::string twin = robot(input) + state.name.substr(robot(state.name).size());
  for (const SurveyedTable& table : file.tables)
    if (table.name == twin && twin != state.name && twin != robot(twin) && table.type == state.type &&
        !table.type.empty())
      throw DataError(
          fmt::format("{}: {} and {} are of two robots, since {} is there, too; name the channels of one robot in "
                      "data.state and data.input",
                      file.path.string(), state.name, input, twin));
}

/// Refuses a table whose rows or cells hold several things.
void refuse_mixed_rows(const std::string& file, const SurveyedTable& table) {
  std::vector<std::string> vectors, numbers, clocks(table.time.begin(), table.time.end());
  const SurveyedChannel* names = nullptr;
  for (const SurveyedChannel& channel : table.channels) {
    if (channel.why_text.starts_with("\"[")) vectors.push_back(channel.name);
    if (channel.moves() && !channel.counts && !names_time(channel.name)) numbers.push_back(channel.name);
    if (channel.alternates) names = &channel;
    const bool clock =
        words_of_name(channel.name).starts_with(" time ") && (clocks.empty() || channel.name != clocks.front());
    if (clock && channel.check.missing > 0) clocks.push_back(channel.name);
  }
  const std::string python =
      fmt::format("python3 -c \"import pandas as pd, numpy as np; d = pd.read_csv('{}'); ", file);
  if (!vectors.empty() && vectors.size() >= numbers.size())
    throw DataError(fmt::format(
        "{}: the cells of {} are vectors; make columns of them: {}[d.insert(0, f'{{c}}_{{j}}', x) for c in ['{}'] for "
        "j, "
        "x in enumerate(zip(*[np.array(s.strip('[]()').replace(',', ' ').split(), float) for s in d.pop(c)]))]; "
        "d.to_csv('flat.csv', index=False)\"",
        file, fmt::join(vectors, ", "), python, fmt::join(vectors, "', '")));
  if (clocks.size() > table.time.size())
    throw DataError(
        fmt::format("{}: the signals behind {} have their own times, so a row is no sample; make a file of each: {}i = "
                    "[d.columns.get_loc(c) for c in ['{}']] + [d.shape[1]]; [d.iloc[:, "
                    "a:b].dropna().rename(columns={{d.columns[a]: "
                    "'time'}}).to_csv(f'table_{{a}}.csv', index=False) for a, b in zip(i, i[1:])]\"",
                    file, fmt::join(clocks, ", "), python, fmt::join(clocks, "', '")));
  if (names != nullptr && numbers.size() == 1 && !table.time.empty())
    throw DataError(
        fmt::format("{0}: {1} holds several signals, which {2} names; make a column of each: "
                    "{3}d.pivot_table(index='{4}', columns='{2}', values='{1}').to_csv('wide.csv')\"",
                    file, numbers.front(), names->name, python, table.time.front()));
}

}  // namespace

void refuse_what_is_apart(const std::vector<SurveyedFile>& files, const Guess& guess) {
  const SurveyedFile& file = files[guess.states.front().file];
  const SurveyedTable& of = file.tables[guess.states.front().table];
  refuse_one_of_many(file, of);
  refuse_mixed_rows(file.path.string(), of);
  if (!guess.inputs.empty() && guess.inputs.front().file == guess.states.front().file)
    refuse_other_robot(file, of, file.tables[guess.inputs.front().table].name);
}

}  // namespace modebank::app
