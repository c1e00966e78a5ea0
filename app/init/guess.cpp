#include "app/init/guess.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "app/init/mounting.hpp"
#include "app/init/unreachable_commands.hpp"
#include "app/init/words.hpp"
#include "ident/base/printable.hpp"
#include "io/arrays/array_reader.hpp"
#include "io/import/expression.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

constexpr std::size_t most_states = 2, most_inputs = 4;

struct Candidate {
  ChannelPlace place;
  const SurveyedTable* table;
  const SurveyedChannel* channel;
  NameScore score;  ///< score from all hints
  NameScore named;  ///< score from the name alone

  bool is_held() const { return channel->check.repeated > most_repeated; }
};

bool same_table(const ChannelPlace& a, const ChannelPlace& b) { return a.file == b.file && a.table == b.table; }

/// The name of the vector of which an instrument measures this axis: gyro_ for gyro_z. Other names stay.
std::string vector_of(const std::string& name) {
  for (const Axis axis : {Axis::x, Axis::y, Axis::z})
    if (names_angular_rate(name, axis) || names_acceleration(name, axis) || names_position(name, axis))
      return name.substr(0, name.size() - 1);
  return name;
}

/// Adds the hints that do not come from names. A channel whose value is held while other channels of its table move is
/// probably a command. Units such as rad/s indicate measurements, and units such as V indicate inputs.
void add_hints(std::vector<Candidate>& all) {
  constexpr int held = 3, unit = 2, named = 8;
  constexpr double moving =
      0.2;  // an instrument that measures in nearly every row repeats at most this share of its values
  for (Candidate& c : all) {
    const bool others_move = std::any_of(all.begin(), all.end(), [&](const Candidate& other) {
      return same_table(other.place, c.place) && other.channel->check.repeated < moving;
    });
    if (c.is_held() && others_move) {
      c.score.input += held;
      c.score.state = std::max(0, c.score.state - held);
    }
    c.score.state += unit_of_measured(c.channel->unit) ? unit : 0;
    c.score.input += unit_of_acting(c.channel->unit) ? unit : 0;
    // What most rows lack is another publisher's.
    if (2 * c.channel->values.array().isNaN().count() > c.channel->values.size()) c.score.state -= 1;
    // What a set point names is the state: level_cm of level_setpoint_cm. What a controller moves acts on it.
    const std::string measured = words_of_measured(c.channel->name);
    for (Candidate& other : all)
      if (!measured.empty() && measured == words_of_name(other.channel->name)) {
        other.score.state += named;
        c.score.input = c.named.input = 1;
      }
  }
}

std::vector<Candidate> candidates_of(const std::vector<SurveyedFile>& files) {
  std::vector<Candidate> all;
  for (std::size_t f = 0; f < files.size(); ++f)
    for (std::size_t t = 0; t < files[f].tables.size(); ++t) {
      const SurveyedTable& table = files[f].tables[t];
      // CSV columns do not contain the name of their instrument, but the file name does: imu_03.csv.
      const std::string from = table.name.empty() ? files[f].path.stem().string() + " " : "";
      for (std::size_t c = 0; c < table.channels.size(); ++c) {
        const SurveyedChannel& channel = table.channels[c];
        if (!channel.moves() || channel.counts || channel.name == table.run || !can_be_stated(channel.name)) continue;
        if (std::find(table.time.begin(), table.time.end(), channel.name) != table.time.end()) continue;
        NameScore score = score_name(channel.name, from + table.type);
        if (!score.ignored) all.push_back({{f, t, c}, &table, &channel, score, score});
      }
    }
  add_hints(all);
  return all;
}

/// The channels in the table of the best candidate whose points are at most `slack` below the best. Points come from
/// all hints or from the name alone. The order is that of the file.
std::vector<const Candidate*> best_of(const std::vector<Candidate>& all, int NameScore::*points, int slack,
                                      std::size_t most) {
  const Candidate* best = nullptr;
  for (const Candidate& c : all)
    if (c.score.*points > 0 && (best == nullptr || c.score.*points > best->score.*points)) best = &c;
  std::vector<const Candidate*> chosen;
  for (const Candidate& c : all)
    if (best != nullptr && same_table(c.place, best->place) && c.score.*points > 0 && chosen.size() < most &&
        (c.score.*points >= best->score.*points - slack ||
         (slack > 0 && c.named.*points >= best->named.*points - slack)))
      chosen.push_back(&c);
  return chosen;
}

/// Guesses the state if no hint indicates one. In tables of u and y, y is usually last. So this takes the channel that
/// is least likely an input, and the last one of equally likely channels.
void guess_state_by_place(const std::vector<Candidate>& all, Guess& guess) {
  const auto least = std::min_element(
      all.rbegin(), all.rend(), [](const Candidate& a, const Candidate& b) { return a.score.input < b.score.input; });
  guess.states = {least->place};
}

/// Guesses the inputs if no name indicates one. Takes channels in the state's table that were not measured together
/// with the state. They must be held, or the table must have few channels.
void guess_inputs_by_place(const std::vector<Candidate>& all, bool by_place, Guess& guess) {
  constexpr std::ptrdiff_t few = 4;
  const auto beside = std::count_if(all.begin(), all.end(),
                                    [&](const Candidate& c) { return same_table(c.place, guess.states.front()); });
  std::vector<std::string> names;
  for (const Candidate& c : all) {
    const bool is_state = std::find(guess.states.begin(), guess.states.end(), c.place) != guess.states.end();
    if (is_state || !same_table(c.place, guess.states.front()) || c.score.state > 0 ||
        vector_of(c.channel->name) != c.channel->name || !words_of_measured(c.channel->name).empty())
      continue;
    if ((!by_place && beside > few && !c.is_held()) || guess.inputs.size() == most_inputs) continue;
    guess.inputs.push_back(c.place);
    names.push_back(c.channel->name);
  }
  if (!names.empty())
    guess.reasons.push_back(fmt::format(
        "no name indicates what acts (data.input); {} {} taken, because no other channel is beside the state",
        fmt::join(names, ", "), names.size() == 1 ? "is" : "are"));
}

void guess_states(std::vector<Candidate>& all, Guess& guess) {
  std::vector<Candidate> measured;
  // Beside a command, wheels are measured and no inputs.
  const bool commanded = std::ranges::any_of(all, [](const Candidate& c) { return c.score.input >= 10; });
  for (const Candidate& c : all)
    if (c.score.state >= c.score.input || (commanded && c.score.state > 0)) measured.push_back(c);
  for (const Candidate* state : best_of(measured.empty() ? all : measured, &NameScore::state, 0, most_states))
    guess.states.push_back(state->place);
}

void guess_inputs(const std::vector<Candidate>& all, Guess& guess) {
  std::vector<Candidate> acting;
  for (const Candidate& c : all) {
    const bool is_state = std::find(guess.states.begin(), guess.states.end(), c.place) != guess.states.end();
    // A channel that the state's instrument measures is not an input.
    const bool beside = same_table(c.place, guess.states.front()) && c.score.input < c.score.state;
    if (!is_state && !beside && c.score.input > 0) acting.push_back(c);
  }
  for (const Candidate* input : best_of(acting, &NameScore::input, 1, most_inputs))
    guess.inputs.push_back(input->place);
}

/// If the gyro lies on its side, replaces the rate about z by the rate about the axis that points up.
void turn_upright(const std::vector<SurveyedFile>& files, Guess& guess) {
  for (ChannelPlace& state : guess.states) {
    const SurveyedTable& table = files[state.file].tables[state.table];
    if (!names_angular_rate(table.channels[state.channel].name, Axis::z)) continue;
    guess.mounting = find_mounting(files, state);
    if (!guess.mounting) continue;
    for (std::size_t c = 0; c < table.channels.size(); ++c)
      if (table.channels[c].name == guess.mounting->up_rate) state.channel = c;
    return;
  }
}

/// An axis that hardly moves beside another one of its vector is no state: that one takes its place.
void leave_resting_axes(const std::vector<SurveyedFile>& files, Guess& guess) {
  constexpr double hardly = 0.02;
  for (ChannelPlace& state : guess.states) {
    const std::vector<SurveyedChannel>& channels = files[state.file].tables[state.table].channels;
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const SurveyedChannel &rests = channels[state.channel], &moves = channels[c];
      const std::string of = vector_of(rests.name);  // x and y alone may be of different kinds
      if (of.empty() || of != vector_of(moves.name) || rests.check.sd >= hardly * moves.check.sd) continue;
      guess.reasons.push_back(
          fmt::format("{} hardly moves beside {}, which is taken (data.state)", rests.name, moves.name));
      state.channel = c;
    }
  }
  guess.states.erase(std::unique(guess.states.begin(), guess.states.end()), guess.states.end());  // a sister may be one
}

// Lines of Python that write files of one table. clang-format leaves raw strings alone.
constexpr auto from_groups = R"(import h5py, pandas as pd
for k, g in h5py.File('{}')['{}'].items():
    c = []
    g.visititems(lambda n, d: c.append(pd.DataFrame(d[()]).add_prefix(n + '_')) if getattr(d, 'ndim', 0) in (1, 2) else None)
    pd.concat(c, axis=1).to_csv(f'run_{{k}}.csv', index=False))";
constexpr auto from_structs = R"(import scipy.io as s
for k, v in enumerate(s.loadmat('{}', simplify_cells=True)['{}']): s.savemat(f'run_{{k}}.mat', v))";
constexpr auto from_vectors = R"(import pandas as pd; d = pd.read_csv('{}')
for c in ['{}']: d = d.join(d.pop(c).str.strip('[]() ').str.split('[, ]+', expand=True).add_prefix(c + '_'))
d.to_csv('flat.csv', index=False))";
constexpr auto from_pairs = R"(import pandas as pd; d = pd.read_csv('{}')
i = [d.columns.get_loc(c) for c in ['{}']] + [d.shape[1]]
for a, b in zip(i, i[1:]): d.iloc[:, a:b].dropna().rename(columns={{d.columns[a]: 'time'}}).to_csv(f'table_{{a}}.csv', index=False))";
constexpr auto from_long = R"(import pandas as pd
pd.pivot_table(pd.read_csv('{}'), **dict(zip(['index', 'columns', 'values'], ['{}']))).to_csv('wide.csv'))";

/// Throws with lines of Python, which get the file and the names.
[[noreturn]] void refuse(const std::string& file, const std::vector<std::string>& names, const std::string& why,
                         const char* python) {
  throw DataError(fmt::format("{}: {} {}:\npython3 -c \"{}\"", file, fmt::join(names, ", "), why,
                              fmt::format(fmt::runtime(python), file, fmt::join(names, "', '"))));
}

/// A group per recording (demo_3), or a struct per recording (log[3]). Instruments of one robot have numbers, too.
void refuse_one_of_many(const SurveyedFile& file, const SurveyedTable& of) {
  const std::size_t last = of.name.find_last_of("0123456789"), first = of.name.find_last_not_of("0123456789", last);
  const std::string word = of.name.substr(0, first + 1), rest = of.name.substr(last + 1);
  const bool structs = word.ends_with('[');
  const auto alike = std::ranges::count_if(file.tables, [&](const SurveyedTable& other) {
    return other.name.starts_with(word) && other.name.ends_with(rest) && other.channels.size() == of.channels.size();
  });
  if (!of.type.empty() || alike < 2 || !(structs || names_run(word))) return;
  const std::size_t end = word.find_last_of(structs ? "[" : ".");
  refuse(file.path.string(), {end == std::string::npos ? "/" : word.substr(0, end)},
         fmt::format("holds {} recordings of the same columns, such as {}; make a file of each", alike, of.name),
         is_hdf5(file.path) ? from_groups : from_structs);
}

/// If the input's robot has a topic like the state's, it is another robot.
void refuse_other_robot(const SurveyedFile& file, const std::string& state, const std::string& input) {
  const std::size_t robot = state.find('/', 1);
  const std::string twin = robot < state.size() ? input.substr(0, input.find('/', 1)) + state.substr(robot) : state;
  if (twin != state && std::ranges::count(file.tables, twin, &SurveyedTable::name) > 0)
    throw DataError(fmt::format("{}: {} and {} are of two robots, as {} is there, too: state data.state and data.input",
                                file.path.string(), state, input, twin));
}

/// Refuses a table whose rows or cells hold several things.
void refuse_mixed_rows(const std::string& file, const SurveyedTable& table) {
  std::vector<std::string> vectors, numbers, clocks = table.time, names = table.time;
  for (const SurveyedChannel& channel : table.channels) {
    if (channel.why_text.starts_with("\"[")) vectors.push_back(channel.name);
    if (channel.moves() && !channel.counts && !names_time(channel.name)) numbers.push_back(channel.name);
    if (channel.why_text.ends_with(changing_text) && !names_time(channel.name)) names.push_back(channel.name);
    const bool clock = words_of_name(channel.name).starts_with(" time ") && channel.check.missing > 0;
    if (clock && std::ranges::count(clocks, channel.name) == 0) clocks.push_back(channel.name);
  }
  if (!vectors.empty() && vectors.size() >= numbers.size())
    refuse(file, vectors, "hold vectors in their cells; make columns of them", from_vectors);
  if (clocks.size() > std::max<std::size_t>(table.time.size(), 1))
    refuse(file, clocks, "are the times of different signals; make a file of each", from_pairs);
  if (table.time.size() != 1 || names.size() != 2 || numbers.size() != 1) return;
  refuse(file, {names[0], names[1], numbers[0]}, "hold several signals, one in each row; make columns of them",
         from_long);
}

/// Whether the name is that of a measured speed or rate, and not of a command.
bool is_measured_motion(const std::vector<SurveyedFile>& files, const ChannelPlace& place) {
  constexpr int least_of_command = 5;
  const int points = score_name(channel_at(files, place).name).input;
  return points > 0 && points < least_of_command;
}

/// Reason why a channel that a user may expect is not used; empty without a reason.
std::string why_left(const SurveyedTable& table, const SurveyedChannel& channel) {
  if (!channel.why_text.empty()) return fmt::format("; column {}: {}", channel.name, channel.why_text);
  if (!channel.moves()) return "";
  if (!can_be_stated(channel.name))
    return fmt::format("; column '{}': a configuration cannot contain an empty name or a control character; rename it",
                       printable_name(channel.name));
  const bool is_time = std::find(table.time.begin(), table.time.end(), channel.name) != table.time.end();
  if (is_time || !score_name(channel.name).ignored) return "";
  return fmt::format(
      "; column {}: the name indicates a time, counter, pose, place or label; rename it if it is a signal",
      channel.name);
}

std::string why_nothing_moves(const std::vector<SurveyedFile>& files) {
  std::string why;
  for (const SurveyedFile& file : files) {
    for (const std::string& note : file.notes) why += "; " + note;
    for (const SurveyedTable& table : file.tables)
      for (const SurveyedChannel& channel : table.channels) why += why_left(table, channel);
  }
  return why;
}

}  // namespace

const SurveyedChannel& channel_at(const std::vector<SurveyedFile>& files, const ChannelPlace& place) {
  return files[place.file].tables[place.table].channels[place.channel];
}

Guess guess_roles(const std::vector<SurveyedFile>& files) {
  std::vector<Candidate> all = candidates_of(files);
  if (all.empty()) {
    throw DataError(fmt::format("{}: no channel can be the state, because no column has numbers that change{}",
                                files.empty() ? "" : files.front().path.string(), why_nothing_moves(files)));
  }
  Guess guess;
  guess_states(all, guess);
  const bool by_place = guess.states.empty();
  if (by_place) {
    guess.reasons.emplace_back(
        "no name indicates the state (data.state); the last channel without a hint of an input is taken");
    guess_state_by_place(all, guess);
  }
  guess_inputs(all, guess);
  if (std::all_of(guess.inputs.begin(), guess.inputs.end(), [&](const ChannelPlace& place) {  // or set points alone
        return !words_of_measured(channel_at(files, place).name).empty();
      }))
    guess_inputs_by_place(all, by_place, guess);
  if (guess.inputs.empty())
    guess.reasons.emplace_back(
        "no channel looks like a command; without inputs modes differ only in the motion of the state itself "
        "(data.input)");
  else if (!by_place && is_measured_motion(files, guess.inputs.front()))
    guess.reasons.emplace_back(
        "no command is recorded: measured motion is used instead, so the model describes how one follows the other "
        "(data.input)");
  replace_unreachable_commands(files, guess);
  turn_upright(files, guess);
  if (!guess.mounting) leave_resting_axes(files, guess);
  const SurveyedFile& file = files[guess.states.front().file];
  const SurveyedTable& table = file.tables[guess.states.front().table];
  refuse_one_of_many(file, table);
  refuse_mixed_rows(file.path.string(), table);
  if (!guess.inputs.empty() && guess.inputs.front().file == guess.states.front().file)
    refuse_other_robot(file, table.name, file.tables[guess.inputs.front().table].name);
  return guess;
}

std::vector<ChannelLeft> channels_left(const std::vector<SurveyedFile>& files, const Guess& guess) {
  const auto has = [](const std::vector<ChannelPlace>& places, const ChannelPlace& place) {
    return std::find(places.begin(), places.end(), place) != places.end();
  };
  std::vector<ChannelLeft> left;
  for (std::size_t f = 0; f < files.size(); ++f)
    for (std::size_t t = 0; t < files[f].tables.size(); ++t)
      for (std::size_t c = 0; c < files[f].tables[t].channels.size(); ++c) {
        const ChannelPlace place{f, t, c};
        const SurveyedTable& table = files[f].tables[t];
        const SurveyedChannel& channel = channel_at(files, place);
        const bool is_time = std::find(table.time.begin(), table.time.end(), channel.name) != table.time.end();
        const bool is_run = !channel.name.empty() && channel.name == table.run;
        if (is_time || is_run || has(guess.states, place) || has(guess.inputs, place)) continue;
        const NameScore score = score_name(channel.name);
        if (!channel.is_number() && !channel.why_text.empty() && !score.ignored)
          left.push_back({channel.name, fmt::format("text ({})", channel.why_text)});
        if (!channel.moves()) continue;
        const bool beside = same_table(place, guess.states.front());
        const bool with_inputs = !guess.inputs.empty() && same_table(place, guess.inputs.front());
        if (channel.name.empty()) {
          left.push_back({fmt::format("column {}", c + 1), "without a name"});
          continue;
        }
        left.push_back(
            {channel.name, score.ignored                  ? "the name indicates a time, counter, pose, place or label"
                           : !can_be_stated(channel.name) ? "the name contains a line end or another control character"
                           : channel.counts               ? "counts up evenly, as times and counters do"
                           : score.input > score.state && with_inputs
                               ? fmt::format("other channels are likelier inputs; at most {} are taken", most_inputs)
                           : beside || with_inputs ? "measured beside the state, or without a hint of its role"
                                                   : "in another table than the state and the inputs"});
        if (!score.ignored && can_be_stated(channel.name) && !channel.counts)
          left.back().points = vector_of(channel.name) != channel.name ? 1 : 2 + score.input;
      }
  return left;
}

}  // namespace modebank::app
