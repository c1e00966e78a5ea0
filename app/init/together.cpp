#include "app/init/together.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/init/words.hpp"
#include "io/arrays/array_reader.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

// Lines of Python that write files of one table. clang-format leaves raw strings alone.
constexpr auto from_groups = R"(import h5py, pandas as pd
for k, g in h5py.File('{}')['{}'].items():
    c = []
    g.visititems(lambda n, d: c.append(pd.DataFrame(d[()]).add_prefix(n + '_')) if getattr(d, 'ndim', 0) in (1, 2) else None)
    pd.concat(c, axis=1).to_csv(f'run_{{k}}.csv', index=False))";
constexpr auto from_structs = R"(import scipy.io, pandas as pd
for k, s in enumerate(scipy.io.loadmat('{}', simplify_cells=True)['{}']):
    c = [pd.DataFrame(v).add_prefix(n + '_') for n, v in s.items() if getattr(v, 'ndim', 0) in (1, 2)]
    pd.concat(c, axis=1).to_csv(f'run_{{k}}.csv', index=False))";
constexpr auto from_vectors =
    R"([d.insert(0, f'{{c}}_{{j}}', x) for c in ['{}'] for j, x in d.pop(c).str.strip('[]() ').str.split('[, ]+', expand=True).items()]; d.to_csv('flat.csv', index=False))";
constexpr auto from_pairs =
    R"(i = [d.columns.get_loc(c) for c in ['{}']] + [d.shape[1]]; [d.iloc[:, a:b].dropna().rename(columns={{d.columns[a]: 'time'}}).to_csv(f'table_{{a}}.csv', index=False) for a, b in zip(i, i[1:])])";
constexpr auto from_long = R"(d.pivot_table(index='{}', columns='{}', values='{}').to_csv('wide.csv'))";

[[noreturn]] void refuse(const std::string& file, const std::string& why, const std::string& python) {
  throw DataError(fmt::format("{}: {}:\npython3 -c \"{}\"", file, why, python));
}

/// A group per recording (demo_3), or a struct per recording (log[3]). Instruments of one robot have numbers, too.
void refuse_one_of_many(const SurveyedFile& file, const SurveyedTable& of) {
  const auto without_digits = [](std::string name) {
    std::erase_if(name, [](char c) { return c >= '0' && c <= '9'; });
    return name;
  };
  const std::size_t last = of.name.find_last_of("0123456789");
  const std::string kind = without_digits(of.name), word = without_digits(of.name.substr(0, last + 1));
  const auto alike = std::count_if(file.tables.begin(), file.tables.end(), [&](const SurveyedTable& other) {
    return without_digits(other.name) == kind && other.channels.size() == of.channels.size();
  });
  const bool structs = word.ends_with('['), recordings = names_run(word) || words_of_name(word).ends_with(" demo ");
  if (!of.type.empty() || alike < 2 || !(structs || recordings)) return;
  const std::size_t end = structs ? word.size() - 1 : of.name.find_last_of('.', last);
  const std::string path = file.path.string(), within = end == std::string::npos ? "/" : of.name.substr(0, end);
  refuse(path, fmt::format("{} is one of {} recordings of the same columns; make a file of each", of.name, alike),
         is_hdf5(path) ? fmt::format(from_groups, path, within) : fmt::format(from_structs, path, within));
}

/// If the input's robot has a table of the same kind as the state's, it is another robot.
void refuse_other_robot(const SurveyedFile& file, const SurveyedTable& state, const std::string& input) {
  const auto robot = [](const std::string& topic) { return topic.substr(0, topic.find('/', 1)); };
  const std::string twin = robot(input) + state.name.substr(robot(state.name).size());
  if (twin == state.name || twin == robot(twin) || state.type.empty()) return;
  for (const SurveyedTable& table : file.tables)
    if (table.name == twin && table.type == state.type)
      throw DataError(
          fmt::format("{}: {} and {} are of two robots, as {} is there, too: state data.state and data.input",
                      file.path.string(), state.name, input, twin));
}

/// Refuses a table whose rows or cells hold several things.
void refuse_mixed_rows(const std::string& file, const SurveyedTable& table) {
  std::vector<std::string> vectors, numbers, clocks(table.time.begin(), table.time.end());
  std::string names;
  for (const SurveyedChannel& channel : table.channels) {
    if (channel.why_text.starts_with("\"[")) vectors.push_back(channel.name);
    if (channel.moves() && !channel.counts && !names_time(channel.name)) numbers.push_back(channel.name);
    if (channel.alternates) names = channel.name;
    const bool clock = words_of_name(channel.name).starts_with(" time ") && channel.check.missing > 0;
    if (clock && (clocks.empty() || channel.name != clocks.front())) clocks.push_back(channel.name);
  }
  const std::string read = fmt::format("import pandas as pd; d = pd.read_csv('{}'); ", file);
  if (!vectors.empty() && vectors.size() >= numbers.size())
    refuse(file, fmt::format("the cells of {} are vectors; make columns of them", fmt::join(vectors, ", ")),
           read + fmt::format(from_vectors, fmt::join(vectors, "', '")));
  if (clocks.size() > table.time.size())
    refuse(file, fmt::format("{} are the times of different signals; make a file of each", fmt::join(clocks, ", ")),
           read + fmt::format(from_pairs, fmt::join(clocks, "', '")));
  if (!names.empty() && numbers.size() == 1 && !table.time.empty())
    refuse(file, fmt::format("{} holds several signals, named by {}; make a column of each", numbers[0], names),
           read + fmt::format(from_long, table.time.front(), names, numbers[0]));
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
