#include "app/init/guess.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/init/mounting.hpp"
#include "app/init/unreachable_commands.hpp"
#include "ident/base/printable.hpp"
#include "io/import/expression.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

constexpr std::size_t most_states = 2, most_inputs = 4;

struct Candidate {
  ChannelPlace place;
  const SurveyedChannel* channel;
  NameScore score;  ///< score from all hints
  NameScore named;  ///< score from the name alone

  bool is_held() const { return channel->check.repeated > most_repeated; }
};

bool same_table(const ChannelPlace& a, const ChannelPlace& b) { return a.file == b.file && a.table == b.table; }

/// The name of the vector of which an instrument measures this axis: gyro_* for gyro_z. Empty for other names.
std::string vector_of(const std::string& name) {
  for (const Axis axis : {Axis::x, Axis::y, Axis::z})
    if (names_angular_rate(name, axis) || names_acceleration(name, axis) || names_position(name, axis))
      return name.substr(0, name.size() - 1) + "*";
  return "";
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
        if (std::ranges::count(table.time, channel.name) > 0) continue;
        NameScore score = score_name(channel.name, from + table.type);
        if (!score.ignored) all.push_back({{f, t, c}, &channel, score, score});
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
    const bool is_state = std::ranges::count(guess.states, c.place) > 0;
    const bool other = !vector_of(c.channel->name).empty() || !words_of_measured(c.channel->name).empty();
    if (is_state || other || !same_table(c.place, guess.states.front()) || c.score.state > 0) continue;
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
    const bool is_state = std::ranges::count(guess.states, c.place) > 0;
    // A channel that the state's instrument measures is not an input.
    const bool beside = same_table(c.place, guess.states.front()) && c.score.input < c.score.state;
    if (!is_state && !beside && c.score.input > 0) acting.push_back(c);
  }
  for (const Candidate* input : best_of(acting, &NameScore::input, 1, most_inputs))
    guess.inputs.push_back(input->place);
}

/// If the gyro lies on its side, replaces the rate about z by the rate about the axis that points up. Else an axis that
/// hardly moves beside another one of its vector is no state: that one takes its place.
void turn_upright(const std::vector<SurveyedFile>& files, Guess& guess) {
  constexpr double hardly = 0.02;
  for (ChannelPlace& state : guess.states) {
    const std::vector<SurveyedChannel>& channels = files[state.file].tables[state.table].channels;
    const std::string name = channels[state.channel].name, vector = vector_of(name);
    if (!guess.mounting && names_angular_rate(name, Axis::z)) guess.mounting = find_mounting(files, state);
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const SurveyedChannel &rests = channels[state.channel], &moves = channels[c];
      const bool is_sister = vector.size() > 1 && vector_of(moves.name) == vector;  // x and y may be of other kinds
      if (!guess.mounting && is_sister && rests.check.sd < hardly * moves.check.sd)
        guess.reasons.push_back(
            fmt::format("{} hardly moves beside {}, which is taken (data.state)", rests.name, moves.name));
      else if (!guess.mounting || moves.name != guess.mounting->up_rate)
        continue;
      state.channel = c;
    }
    if (guess.mounting) break;
  }
  guess.states.erase(std::unique(guess.states.begin(), guess.states.end()), guess.states.end());  // a sister may be one
}

// Refusals with lines of Python that write files of one table. clang-format leaves raw strings alone.
constexpr auto of_groups = R"py({0}: {1} is one of several recordings; a file each: python3 -c "import h5py, pandas as p
for k, g in h5py.File('{0}')['/{2}'.replace('.', '/')].items():
    s = []; g.visit(s.append); a = [(n, g[n][()]) for n in s if getattr(g[n], 'ndim', 0) in (1, 2)]
    p.concat([p.DataFrame(v).add_prefix(n + '_') for n, v in a], axis=1).to_csv(f'run_{{k}}.csv', index=False)")py";
constexpr auto of_structs = R"py({0}: {1} is one of several recordings; a file each: python3 -c "import scipy.io as s
for k, v in enumerate(s.loadmat('{0}', simplify_cells=True)['{2}']): s.savemat(f'run_{{k}}.mat', v)")py";
constexpr auto of_vectors =
    R"py({0}: '{1}' hold vectors: python3 -c "import pandas; d = pandas.read_csv('{0}')
for c in ['{1}']: d = d.join(d.pop(c).str.strip('[]() ').str.split('[;, ]+', expand=True).add_prefix(c + '_'))
d.to_csv('flat.csv', index=False)")py";
constexpr auto of_pairs = R"py({0}: '{1}' are times of different signals; a file each: python3 -c "import pandas
d = pandas.read_csv('{0}'); c = d.columns; i = sorted(map(c.get_loc, ['{1}'])) + [len(c)]
for a, b in zip(i, i[1:]): d.iloc[:, a:b].dropna().to_csv(f't{{a}}.csv', header=['time', *c[a + 1:b]], index=0)")py";
constexpr auto of_names = R"py({0}: {3} holds the signals that {2} names; as columns: python3 -c "import pandas
pandas.pivot_table(pandas.read_csv('{0}'), index='{1}', columns='{2}', values='{3}').to_csv('wide.csv')")py";

/// Refuses a table whose rows or cells hold several things.
void refuse_mixed_rows(const std::string& file, const SurveyedTable& table) {
  std::vector<std::string> vectors, numbers, names, clocks = table.time;
  for (const SurveyedChannel& channel : table.channels) {
    if (channel.why_text.find_first_of("[(") == 1) vectors.push_back(channel.name);
    if (channel.moves() && !channel.counts && !names_time(channel.name)) numbers.push_back(channel.name);
    if (channel.why_text.ends_with(changing_text) && !names_time(channel.name)) names.push_back(channel.name);
    const bool clock = names_time(channel.name) || words_of_name(channel.name).starts_with(" time ");
    if (clock && channel.check.missing > 0 && std::ranges::count(clocks, channel.name) == 0)
      clocks.push_back(channel.name);
  }
  if (!vectors.empty() && vectors.size() >= numbers.size())
    throw DataError(fmt::format(of_vectors, file, fmt::join(vectors, "', '")));
  if (clocks.size() > std::max<std::size_t>(table.time.size(), 1))
    throw DataError(fmt::format(of_pairs, file, fmt::join(clocks, "', '")));
  if (table.time.size() == 1 && !names.empty() && numbers.size() == 1)
    throw DataError(fmt::format(of_names, file, table.time[0], names[0], numbers[0]));
}

/// Refuses what does not belong together.
void refuse_mixed(const std::vector<SurveyedFile>& files, const Guess& guess) {
  const SurveyedFile& file = files[guess.states.front().file];
  const SurveyedTable& table = file.tables[guess.states.front().table];
  const std::string path = file.path.string(), state = table.name;
  // A group per recording (demo_3), or a struct per recording (log[3]). Instruments of one robot have numbers, too.
  constexpr auto digits = "0123456789";
  const std::size_t last = state.find_last_of(digits), first = state.find_last_not_of(digits, last);
  const std::string word = state.substr(0, first + 1), own = state.substr(0, last + 1);
  const auto is_other = [&, columns = table.channels.size()](const SurveyedTable& of) {
    return of.name.starts_with(word) && !of.name.starts_with(own) && of.channels.size() == columns;
  };
  const bool numbered = word.empty() || word.ends_with('.') || word.ends_with('[') || names_run(word);
  if (table.type.empty() && numbered && std::ranges::any_of(file.tables, is_other))
    throw DataError(word.ends_with('[') ? fmt::format(of_structs, path, state, word.substr(0, word.size() - 1))
                                        : fmt::format(of_groups, path, state, word.substr(0, word.rfind('.') + 1)));
  // If an input's robot has a topic like the state's, it is another robot.
  const auto robot_of = [](const std::string& topic) { return topic.substr(0, topic.find('/', 1)); };
  for (const ChannelPlace& place : guess.inputs) {
    const std::string& input = files[place.file].tables[place.table].name;
    const std::string twin = robot_of(input) + state.substr(robot_of(state).size());
    if (twin != state && twin != input && std::ranges::count(file.tables, twin, &SurveyedTable::name) > 0)
      throw DataError(fmt::format("{}: {} and {} are of two robots, as {} is there: state data.state and data.input",
                                  path, state, input, twin));
  }
  refuse_mixed_rows(path, table);
}

/// Reason why a channel that a user may expect is not used; empty without a reason.
std::string why_left(const SurveyedTable& table, const SurveyedChannel& channel) {
  if (!channel.why_text.empty()) return fmt::format("; column {}: {}", channel.name, channel.why_text);
  if (!channel.moves()) return "";
  if (!can_be_stated(channel.name))
    return fmt::format("; column '{}': a configuration cannot contain an empty name or a control character; rename it",
                       printable_name(channel.name));
  const bool is_time = std::ranges::count(table.time, channel.name) > 0;
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
    guess.reasons.emplace_back("no name indicates the state (data.state); the last channel without a hint is taken");
    guess_state_by_place(all, guess);
  }
  guess_inputs(all, guess);
  if (std::all_of(guess.inputs.begin(), guess.inputs.end(), [&](const ChannelPlace& place) {  // or set points alone
        return !words_of_measured(channel_at(files, place).name).empty();
      }))
    guess_inputs_by_place(all, by_place, guess);
  constexpr int least_of_command = 5;  // points; names of measured speeds or rates have fewer
  const int points = guess.inputs.empty() ? 0 : score_name(channel_at(files, guess.inputs.front()).name).input;
  if (guess.inputs.empty())
    guess.reasons.emplace_back(
        "no channel looks like a command (data.input); modes differ only in the motion of the state itself");
  else if (!by_place && points > 0 && points < least_of_command)
    guess.reasons.emplace_back(
        "no command is recorded: measured motion is used instead (data.input); models tell how one follows the other");
  replace_unreachable_commands(files, guess);
  turn_upright(files, guess);
  refuse_mixed(files, guess);
  return guess;
}

std::vector<ChannelLeft> channels_left(const std::vector<SurveyedFile>& files, const Guess& guess) {
  const auto has = [](const std::vector<ChannelPlace>& places, const ChannelPlace& place) {
    return std::ranges::count(places, place) > 0;
  };
  std::vector<ChannelLeft> left;
  for (std::size_t f = 0; f < files.size(); ++f)
    for (std::size_t t = 0; t < files[f].tables.size(); ++t)
      for (std::size_t c = 0; c < files[f].tables[t].channels.size(); ++c) {
        const ChannelPlace place{f, t, c};
        const SurveyedTable& table = files[f].tables[t];
        const SurveyedChannel& channel = channel_at(files, place);
        const bool is_time = std::ranges::count(table.time, channel.name) > 0;
        const bool is_run = !channel.name.empty() && channel.name == table.run;
        if (is_time || is_run || has(guess.states, place) || has(guess.inputs, place)) continue;
        const NameScore score = score_name(channel.name);
        if (!channel.is_number() && !channel.why_text.empty() && !score.ignored)
          left.push_back({channel.name, fmt::format("text ({})", channel.why_text),
                          channel.why_text.find("data.na") == std::string::npos ? 0 : 2});
        if (!channel.moves()) continue;
        const bool beside = same_table(place, guess.states.front());
        const bool with_inputs = !guess.inputs.empty() && same_table(place, guess.inputs.front());
        left.push_back({channel.name.empty() ? fmt::format("column {}", c + 1) : channel.name,
                        channel.name.empty()           ? "without a name"
                        : score.ignored                ? "the name indicates a time, counter, pose, place or label"
                        : !can_be_stated(channel.name) ? "the name contains a line end or another control character"
                        : channel.counts               ? "counts up evenly, as times and counters do"
                        : score.input > score.state && with_inputs
                            ? fmt::format("other channels are likelier inputs; at most {} are taken", most_inputs)
                        : beside || with_inputs ? "measured beside the state, or without a hint of its role"
                                                : "in another table than the state and the inputs"});
        if (!score.ignored && can_be_stated(channel.name) && !channel.counts)
          left.back().points = vector_of(channel.name).empty() ? 2 + score.input : 1;
      }
  std::ranges::stable_sort(left, std::greater<>(), &ChannelLeft::points);
  return left;
}

}  // namespace modebank::app
