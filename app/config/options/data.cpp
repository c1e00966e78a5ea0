#include <cmath>
#include <sstream>

#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"
#include "io/import/derived.hpp"
#include "io/table/stamp_pattern.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// data.lag_s: a number, or auto.
Option lag_option() {
  Option result =
      numeric("data.lag_s", any(), "s",
              "delay between an input's stamp and its effect (negative: inputs are stamped late). auto estimates one "
              "lag on the training runs and applies it where cross-validation gains",
              MODEBANK_FIELD(data.lag_s));
  result.range = "a number or auto";
  result.set = [set = result.set](Config& config, const std::string& text) {
    if (text != "auto") set(config, text);
    config.data.lag_auto = text == "auto";
    if (config.data.lag_auto) config.data.lag_s = 0.0;
  };
  result.get = [get = result.get](const Config& config) { return config.data.lag_auto ? "auto" : get(config); };
  return result;
}

Option skip_rows_option() {
  Option result = numeric("data.skip_rows", at_least(0), "lines",
                          "number of title lines above the table of a text file; auto: found for each file",
                          MODEBANK_FIELD(data.format.skip_rows));
  result.range = "a whole number >= 0, or auto";
  result.set = [set = result.set](Config& config, const std::string& text) {
    config.data.format.skip_automatic = text == "auto";
    set(config, text == "auto" ? "0" : text);
  };
  result.get = [get = result.get](const Config& config) {
    return config.data.format.skip_automatic ? "auto" : get(config);
  };
  return result;
}

/// data.quantum: numbers, or a word.
Option quantum_option() {
  Option result =
      numeric("data.quantum", each(above(0)), "state unit",
              "rounding step q of the states, one for each or one for all. R is then at least q^2 / 12, and scores "
              "are masses of intervals of this width. auto: the step in the training runs, if it is at least a third "
              "of their residuals' standard deviation; none: values are exact",
              MODEBANK_FIELD(data.quantum));
  result.range = "none, auto or numbers > 0";
  result.set = [set = result.set](Config& config, const std::string& text) {
    const bool word = text == "auto" || text == "none" || text.empty();
    if (word) config.data.quantum.clear();
    if (!word) set(config, text);
    config.data.quantum_auto = text == "auto";
  };
  result.get = [get = result.get](const Config& config) {
    if (config.data.quantum_auto) return std::string("auto");
    return config.data.quantum.empty() ? std::string("none") : get(config);
  };
  return result;
}

Option time_format_option() {
  Option result = text("data.time_format", "strptime's letters, %f for the fraction of a second",
                       "form of times that are text, for example %d.%m.%Y %H:%M:%S.%f. Empty: the first usual form "
                       "that fits all values. Times without a date count from midnight and continue past the next one",
                       MODEBANK_FIELD(data.time_format));
  result.set = [set = result.set](Config& config, const std::string& text) {
    if (!text.empty()) StampPattern{text};  // throws for a bad format, with the reason
    set(config, text);
  };
  return result;
}

/// data.split: none, blocks N, or last P %.
Option split_option() {
  Option result =
      of_several("data.split", "none, blocks N (2 to 1000) or last P % (1 to 99)", "",
                 "cuts every run into several. blocks N: blocks 1, 3, ... train, blocks 2, 4, ... are held out. last P "
                 "%: the end of the run is held out, the rest trains. One window with its lags is dropped at each cut");
  result.set = [](Config& config, const std::string& text) {
    std::istringstream words(text);
    std::string kind, rest;
    double number = 0.0;
    words >> kind;
    SplitOptions& split = config.data.split;
    if (kind == "none" && !(words >> rest)) return void(split = {});
    if (!(words >> number) || (kind != "blocks" && kind != "last")) throw std::invalid_argument("is no way to split");
    const bool percent = bool(words >> rest);
    const bool blocks = kind == "blocks";
    if (words >> rest || (percent && (blocks || rest != "%"))) throw std::invalid_argument("is no way to split");
    if (blocks ? !(number >= 2 && number <= 1000 && number == std::floor(number)) : !(number >= 1 && number <= 99))
      throw std::invalid_argument("is out of range");
    split = {};
    split.kind = blocks ? SplitKind::blocks : SplitKind::last;
    split.last_percent = blocks ? 0.0 : number;
    split.blocks = blocks ? static_cast<int>(number) : 0;
  };
  result.get = [](const Config& config) -> std::string {
    const SplitOptions& split = config.data.split;
    if (split.kind == SplitKind::none) return "none";
    return split.kind == SplitKind::blocks ? fmt::format("blocks {}", split.blocks)
                                           : fmt::format("last {:g} %", split.last_percent);
  };
  return result;
}

/// Throws an exception for a bad expression. The caller adds file and line.
void check_derived(const std::string& line) {
  try {
    parse_derived(line);
  } catch (const ConfigurationError& error) {
    throw std::invalid_argument(std::string("is not a derived channel: ") + error.what());
  }
}

}  // namespace

std::vector<Option> data_options() {
  using enum Stage;
  return {
      text("data.root", "a folder",
           "folder that relative data paths start from; empty: $MODEBANK_DATA, else this file's folder",
           MODEBANK_FIELD(data.root))
          .touch("when the data are in another folder than the configuration"),
      text("data.inputs", "a path with at most one *, or paths",
           "files of the runs, one per run. The part that * matches names the run, else the file's name does",
           MODEBANK_FIELD(data.inputs))
          .touch("always: the log's path", data, basic),
      text("data.states", "a path with at most one *, or paths",
           "files of the states, one per run; empty: states are columns of the inputs files",
           MODEBANK_FIELD(data.states))
          .touch("when measurements and commands are in different files", data, basic),
      text("data.state", "column names", "columns of the measured states, which the model predicts",
           MODEBANK_FIELD(data.state))
          .touch("always", data, basic),
      text("data.input", "column names", "columns of the inputs: commands or other causes of the motion",
           MODEBANK_FIELD(data.input))
          .touch("always, unless the system has no input", data, basic),
      lines("data.derive", "NAME [unit] = EXPRESSION",
            "a channel computed from others: + - * / ^, comparisons, && ||, A ? B : C, sin ... atan2 sqrt abs min max, "
            "diff (per second), unwrap, yaw(x, y, z, w), rotate_x, _y, _z(roll, pitch, yaw, x, y, z). Put names with "
            "blanks or dots in 'single quotes'",
            check_derived, MODEBANK_FIELD(data.derive))
          .touch("when the log lacks the channel that you need: a yaw rate from a quaternion, another unit", data,
                 basic),
      text("data.where", "an expression",
           "condition on the samples to use. Where it is false or missing, samples are left out, and the gap splits "
           "the run; empty: all are used",
           MODEBANK_FIELD(data.where))
          .touch("when parts of a log must be left out: handling by people, a fault, a motor that is off", data),
      text("data.truth", "column names", "columns of the true states, one per state; empty: none",
           MODEBANK_FIELD(data.truth))
          .touch("only for simulated data or an external reference (motion capture): estimates are compared with it, "
                 "nothing learns from it",
                 data),
      text("data.label", "a column name",
           "column with a known class of each sample, such as the ground: text or whole numbers. A missing label "
           "repeats the one before. Modes are compared with it (/evaluation/confusion); empty: none",
           MODEBANK_FIELD(data.label))
          .touch(
              "when the log has a column for the ground, gear or floor: modes are named after it and compared with it",
              data, basic),
      text("data.state_unit", "units",
           "units of the states, one per state or one for all; the archive and plots show them",
           MODEBANK_FIELD(data.state_unit))
          .touch("when the log has no units", data),
      text("data.input_unit", "units", "units of the inputs, one per input or one for all",
           MODEBANK_FIELD(data.input_unit))
          .touch("when the log has no units", data),
      text("data.time", "one column name, or two of a stamp in two parts",
           "column of the times: numbers or text. In a recording, time is the header's stamp, else the time of "
           "receipt; receive_time is always the time of receipt. Empty: row k is at k / rate_hz",
           MODEBANK_FIELD(data.time))
          .touch("when the column has another name; receive_time, when the stamps of a recording are wrong", data,
                 basic),
      words("data.time_unit",
            "unit of the times; auto: from the column's name, the size of the values or their steps, else seconds",
            MODEBANK_FIELD(data.time_unit))
          .touch("when durations on the screen are off by 60, a thousand or a million", data),
      time_format_option().touch(
          "when a message shows a time that could not be read, or whose day and month may be swapped", data),
      words("data.separator", "separator of the fields in text files; auto: found in the first rows",
            MODEBANK_FIELD(data.format.separator))
          .touch("when a text file is read wrongly, as with mixed separators", data),
      words("data.decimal", "decimal mark in text files; auto: found in the first rows",
            MODEBANK_FIELD(data.format.decimal))
          .touch("when numbers with a decimal comma are read wrongly", data),
      text("data.na", "words",
           "words for a missing value in text files, in capitals or not; a number such as -999 is compared by value. "
           "Empty fields and NaN are missing without this key",
           MODEBANK_FIELD(data.format.na))
          .touch("when your logger writes a word or a number such as -999 where nothing was measured", data),
      skip_rows_option().touch("when a text file has a title above its table; `modebank init` finds the number", data),
      words("data.header",
            "whether the first row of a text file names the columns; else they are c1, c2, .... auto: it does unless "
            "it contains numbers",
            MODEBANK_FIELD(data.format.header))
          .touch("when the first row is taken for names by mistake, or for values", data),
      text("data.definitions", "a folder",
           "folder with .msg files. They define message types of ROS 2 that the recording and this program lack; "
           "empty: none",
           MODEBANK_FIELD(data.format.definitions))
          .touch("when a ROS 2 .db3 recording has messages of your own types", data),
      words("data.join",
            "how states and inputs are brought together: states interpolated at the inputs' times, or row by row",
            MODEBANK_FIELD(data.join))
          .touch("row, when row k of both files was written together and the times are unreliable", data),
      text("data.run", "a column name", "column whose value separates runs inside one file; empty: one run per file",
           MODEBANK_FIELD(data.run))
          .touch("when one file holds several runs", data),
      numeric("data.rate_hz", at_least(0), "Hz",
              "rate of the samples to use; 0: the inputs' own times. Else states are interpolated linearly and inputs "
              "are held. Below the log's rate, channels that change at every sample are averaged over each step",
              MODEBANK_FIELD(data.rate_hz))
          .touch("when times jitter or values repeat, which `modebank check` shows", data, basic),
      lag_option().touch("auto, when states and inputs come from two instruments; a number, when you know it", data,
                         basic),
      quantum_option().touch("auto, when the finding says that measurements repeat, and they come in steps", data),
      words("data.missing",
            "treatment of NaN, infinite and empty values. error: stop. gap: split the run there. predict: a missing "
            "state is predicted without an update, a missing input repeats the one before",
            MODEBANK_FIELD(data.missing))
          .touch("when reading stops at a missing value: gap for lost samples, predict for single values", data),
      words("data.disorder",
            "treatment of times that go backwards or repeat. error: stop. sort: sort the rows and keep the first of "
            "each time",
            MODEBANK_FIELD(data.disorder))
          .touch("sort, when reading stops there and the logger mixes up rows", data),
      split_option().touch("for a single long run: blocks 10. Only held-out runs give evidence", data, basic),
      text("data.train", "run names", "training runs; empty: the runs 0, 2, 4, ... in name order",
           MODEBANK_FIELD(data.train))
          .touch("when certain runs must train, such as those with much excitation", data),
      text("data.test", "run names", "held-out runs; empty: all others", MODEBANK_FIELD(data.test))
          .touch("when certain runs must be held out: another day, another ground", data, basic),
  };
}

}  // namespace modebank::app
