#include "app/study/space/study_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>

#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "app/config/option_text.hpp"
#include "app/study/space/data_hashes.hpp"
#include "app/study/space/study_space.hpp"
#include "ident/base/seed.hpp"
#include "io/archive/study_file.hpp"
#include "io/files/input_file.hpp"
#include "io/files/sha256.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// At most 2^53, because JavaScript's numbers are doubles, which are exact up to this value.
std::uint64_t repeat_seed(std::uint64_t seed, std::int64_t repeat) {
  constexpr int bits = 32;
  return repeat == 0 ? seed : derive_seed(seed, "study.repeat", static_cast<std::uint64_t>(repeat)) >> (64 - bits);
}

/// A point, and the seeds of its runs.
struct Setting {
  StudyPoint point;
  std::vector<std::uint64_t> seeds;
};

/// The settings of a space. Points that differ only in job.seed are repeats of one setting. So job.seed is removed from
/// the keys of the space.
std::vector<Setting> settings_of(const Config& config, StudySpace& space) {
  const auto varied = std::find(space.keys.begin(), space.keys.end(), "job.seed");
  const auto column = varied - space.keys.begin();
  const bool is_varied = varied != space.keys.end();
  if (is_varied) space.keys.erase(varied);
  std::vector<Setting> settings;
  std::map<StudyPoint, std::size_t> places;
  for (StudyPoint& point : space.points) {
    std::uint64_t seed = config.job.seed;
    if (is_varied) {
      parse_value(point[static_cast<std::size_t>(column)], seed);
      point.erase(point.begin() + column);
    }
    const auto [place, fresh] = places.try_emplace(point, settings.size());
    if (fresh) settings.push_back({point, {}});
    settings[place->second].seeds.push_back(seed);
  }
  return settings;
}

/// The message with which `modebank run` would refuse the configuration; empty if `run` accepts it.
std::string objection(const Config& config) {
  try {
    validate(config);
    return {};
  } catch (const ConfigurationError& error) {
    return error.what();
  }
}

void add_setting(const Config& config, const std::vector<std::string>& keys, const Setting& setting, DataHashes& data,
                 StudyPlan& plan) {
  TrialRow row;
  row.varied = setting.point;
  for (const std::uint64_t seed : setting.seeds)
    for (std::int64_t repeat = 0; repeat < config.study.repeats; ++repeat, ++row.repeat) {
      row.seed = repeat_seed(seed, repeat);
      const Config trial = trial_config(config, keys, row);
      row.message = objection(trial);
      row.status = row.message.empty() ? TrialStatus::planned : TrialStatus::dropped;
      if (row.message.empty()) data.add(trial);
      plan.table.rows.push_back(row);
      if (row.status == TrialStatus::dropped) return;
    }
}

NamedColumn text_column(const std::string& name, const std::vector<TrialRow>& rows,
                        const std::function<std::string(const TrialRow&)>& text) {
  std::vector<std::string> values;
  for (const TrialRow& row : rows) values.push_back(text(row));
  return {name, std::move(values)};
}

/// The values of the column with this name and type. Throws if there is none, because the file is then not a plan.
template <class T>
const std::vector<T>& values_of(const StudyFile& file, std::size_t column, const std::string& name) {
  const NamedColumn& found = file.columns.at(column);
  if (found.name != name)
    throw DataError(fmt::format("not a plan: its column {} is {}, expected {}", column, found.name, name));
  const auto* const values = std::get_if<std::vector<T>>(&found.values);
  if (!values) throw DataError(fmt::format("not a plan: its column {} has values of another type", name));
  return *values;
}

/// Checks a row. This is needed because another program may have written the plan, and its keys become file names.
void check_row(const TrialRow& row, std::size_t r) {
  const bool dropped = row.status == TrialStatus::dropped;
  if (!is_sha256(row.key) && !(dropped && row.key.empty()))
    throw DataError(fmt::format("row {}: the key \"{}\" is not 64 hexadecimal digits", r, row.key));
  if (row.repeat < 0) throw DataError(fmt::format("row {}: repeat is {}", r, row.repeat));
}

StudyPlan plan_of(const StudyFile& file);

/// Number of columns in plan.h5 before the varied keys (the key), and after them (repeat, seed, status, message).
constexpr std::size_t columns_before = 1, columns_after = 4;

std::string quoted(const std::string& value) { return value.empty() ? "''" : "'" + value + "'"; }

/// One line per changed key that affects a run or the list of runs: "mixture.restarts '5' -> '7'".
std::string key_differences(const std::string& before, const std::string& now) {
  const auto values_before = resolved_values(before), values_now = resolved_values(now);
  std::string text;
  for (const auto& [key, value] : values_now) {
    static const std::vector<std::string> plan_keys{"study.vary", "study.together", "study.sample", "study.repeats"};
    const bool decides = decides_numbers(key) || std::find(plan_keys.begin(), plan_keys.end(), key) != plan_keys.end();
    const auto old = values_before.find(key);
    const std::string old_value = old == values_before.end() ? "" : old->second;
    if (decides && old_value != value) text += fmt::format("\n  {} {} -> {}", key, quoted(old_value), quoted(value));
  }
  return text;
}

std::string file_differences(const std::vector<InputFile>& before, const std::vector<InputFile>& now) {
  std::map<std::string, std::string> hashes;
  for (const InputFile& file : before) hashes[file.path] = file.sha256;
  std::string text;
  for (const InputFile& file : now) {
    const auto old = hashes.find(file.path);
    if (old == hashes.end())
      text += fmt::format("\n  {} is new", file.path);
    else if (old->second != file.sha256)
      text +=
          fmt::format("\n  {} has SHA-256 {}, had {}", file.path, file.sha256.substr(0, 16), old->second.substr(0, 16));
    if (old != hashes.end()) hashes.erase(old);
  }
  for (const auto& [path, hash] : hashes) text += fmt::format("\n  {} is not among the files now", path);
  return text;
}

}  // namespace

std::string trial_key(const Config& trial, const std::string& data_hash, const std::string& version) {
  return sha256_hex(config_hash(trial) + data_hash + version);
}

Config trial_config(const Config& study, const std::vector<std::string>& varied_keys, const TrialRow& row) {
  Config config = study;
  for (std::size_t i = 0; i < varied_keys.size(); ++i) find_option(varied_keys[i])->set(config, row.varied[i]);
  config.job.seed = row.seed;
  config.archive = {};
  config.archive.output = trial_archive(study.study.output, row.key).string();
  config.study = {};
  return config;
}

StudyPlan make_plan(const Config& config, Provenance provenance) {
  StudyPlan plan;
  plan.config = resolved_text(config);
  plan.provenance = std::move(provenance);
  StudySpace space = lay_out(config);
  const std::vector<Setting> settings = settings_of(config, space);
  plan.table.varied_keys = space.keys;
  plan.repeated_points = space.repeated;
  DataHashes data;
  for (const Setting& setting : settings) add_setting(config, space.keys, setting, data, plan);
  data.read();
  for (TrialRow& row : plan.table.rows) {
    if (row.status == TrialStatus::dropped) continue;
    const Config trial = trial_config(config, space.keys, row);
    row.key = trial_key(trial, data.of(trial), plan.provenance.modebank_version);
  }
  plan.provenance.inputs = data.files();
  plan.provenance.data_hash = data_hash(plan.provenance.inputs);
  return plan;
}

std::filesystem::path trial_archive(const std::filesystem::path& folder, const std::string& key) {
  return folder / "trials" / (key + ".h5");
}

std::filesystem::path plan_file(const std::filesystem::path& folder) { return folder / "plan.h5"; }

void write_plan(const std::filesystem::path& folder, const StudyPlan& plan) {
  const std::vector<TrialRow>& rows = plan.table.rows;
  StudyFile file{plan.provenance, plan.config, "plan", {}, {}, {}};
  file.columns.push_back(text_column("key", rows, [](const TrialRow& row) { return row.key; }));
  for (std::size_t i = 0; i < plan.table.varied_keys.size(); ++i)
    file.columns.push_back(
        text_column(plan.table.varied_keys[i], rows, [i](const TrialRow& row) { return row.varied[i]; }));
  std::vector<std::int64_t> repeats;
  std::vector<std::uint64_t> seeds;
  for (const TrialRow& row : rows) {
    repeats.push_back(row.repeat);
    seeds.push_back(row.seed);
  }
  file.columns.push_back({"repeat", std::move(repeats)});
  file.columns.push_back({"seed", std::move(seeds)});
  file.columns.push_back(
      text_column("status", rows, [](const TrialRow& row) { return std::string(name_of(row.status)); }));
  file.columns.push_back(text_column("message", rows, [](const TrialRow& row) { return row.message; }));
  write_study_file(plan_file(folder), file);
}

StudyPlan read_plan(const std::filesystem::path& folder) {
  const StudyFile file = read_study_file(plan_file(folder), "plan");
  try {
    return plan_of(file);
  } catch (const DataError& error) {
    throw DataError(plan_file(folder).string() + ": " + error.what());
  }
}

namespace {

StudyPlan plan_of(const StudyFile& file) {
  if (file.columns.size() < columns_before + columns_after) throw DataError("not a plan");
  StudyPlan plan{file.config, file.provenance, {}};
  const std::size_t varied = file.columns.size() - columns_before - columns_after, after = columns_before + varied;
  const auto& keys = values_of<std::string>(file, 0, "key");
  const auto& repeats = values_of<std::int64_t>(file, after, "repeat");
  const auto& seeds = values_of<std::uint64_t>(file, after + 1, "seed");
  const auto& status = values_of<std::string>(file, after + 2, "status");
  const auto& messages = values_of<std::string>(file, after + 3, "message");
  plan.table.rows.resize(keys.size());
  for (std::size_t i = columns_before; i < after; ++i) {
    const std::string& name = file.columns[i].name;
    if (!find_option(name)) throw DataError(fmt::format("not a plan: it varies \"{}\", which is not a key", name));
    plan.table.varied_keys.push_back(name);
    const auto& values = values_of<std::string>(file, i, name);
    for (std::size_t r = 0; r < keys.size(); ++r) plan.table.rows[r].varied.push_back(values[r]);
  }
  for (std::size_t r = 0; r < keys.size(); ++r) {
    TrialRow& row = plan.table.rows[r];
    row.key = keys[r];
    row.repeat = repeats[r];
    row.seed = seeds[r];
    const auto known = parse_name<TrialStatus>(status[r]);
    if (!known) throw DataError(fmt::format("row {}: unknown status \"{}\"", r, status[r]));
    row.status = *known;
    row.message = messages[r];
    check_row(row, r);
  }
  return plan;
}

}  // namespace

void check_plan_goes_on(const StudyPlan& before, const StudyPlan& now, const std::filesystem::path& folder) {
  std::map<std::string, bool> keys;
  for (const TrialRow& row : now.table.rows) keys[row.key] = true;
  std::size_t lost = 0;
  for (const TrialRow& row : before.table.rows)
    lost += !row.key.empty() && row.status != TrialStatus::dropped && !keys.count(row.key);
  if (lost == 0) return;
  const std::string head =
      fmt::format("{}: {} of its {} runs are no longer in the plan", folder.string(), lost, before.table.rows.size());
  const std::string advice =
      "\na study may get more values, but must keep its present values; set another study.output";
  if (before.provenance.modebank_version != now.provenance.modebank_version)
    throw ConfigurationError(fmt::format("{}: it was planned by modebank {}, but this is {}{}", head,
                                         before.provenance.modebank_version, now.provenance.modebank_version, advice));
  const std::string files = file_differences(before.provenance.inputs, now.provenance.inputs);
  const std::string keys_text = key_differences(before.config, now.config);
  if (!keys_text.empty())
    throw ConfigurationError(
        fmt::format("{}; the configuration changed (before -> now):{}{}", head, keys_text, advice));
  throw DataError(fmt::format("{}; the data changed:{}{}", head, files, advice));
}

void check_plan_is_of(const StudyPlan& plan, const Config& config, const std::filesystem::path& folder) {
  const std::string differences = key_differences(plan.config, resolved_text(config));
  if (!differences.empty())
    throw ConfigurationError(fmt::format(
        "{} was planned with another configuration (planned -> now):{}\nplan it again first with --study.stage plan",
        folder.string(), differences));
}

}  // namespace modebank::app
