#include <cmath>
#include <sstream>

#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"
#include "io/import/derived.hpp"
#include "io/table/stamp_pattern.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// A number, or a word in its place.
Option lag_option() {
  Option result = numeric("data.lag_s", any(), "s",
                          "inputs act this much later (negative: earlier); auto estimates lag and clock drift per run "
                          "on the training runs and applies them if cross-validation among these gains",
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
                          "lines of a title above the table of text files; auto: found out for each file",
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

/// Numbers, or a word in their place.
Option quantum_option() {
  Option result =
      numeric("data.quantum", each(above(0)), "state unit",
              "states are multiples of this, one for each or one for all: a value says which interval the "
              "state lies in, and filters and learning take it so; auto: what the training runs show, where "
              "it is a third of their residuals' standard deviation or more; none: values as they stand",
              MODEBANK_FIELD(data.quantum))
          .touch("auto, when the finding says that measurements come in steps too coarse to compare densities");
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
                       "the form of times that are text, as %d.%m.%Y %H:%M:%S.%f; empty: the first of a table of usual "
                       "forms that fits all values. Without a date times count from midnight and go on past the next",
                       MODEBANK_FIELD(data.time_format));
  result.set = [set = result.set](Config& config, const std::string& text) {
    if (!text.empty()) StampPattern{text};  // throws what is wrong with it
    set(config, text);
  };
  return result;
}

/// none, blocks N, or last P %.
Option split_option() {
  Option result = of_several(
      "data.split", "none, blocks N (2 to 1000) or last P % (1 to 99)", "",
      "every run becomes runs of its own: N blocks, of which the 1st, 3rd, ... train and the others are held out, or "
      "what "
      "comes before and the last P %, held out; a window and its lags are dropped in between");
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

/// For a message that says in which line the key stands.
void check_derived(const std::string& line) {
  try {
    parse_derived(line);
  } catch (const ConfigurationError& error) {
    throw std::invalid_argument(std::string("is no derived channel: ") + error.what());
  }
}

}  // namespace

std::vector<Option> data_options() {
  using enum Stage;
  return {
      text("data.root", "a folder", "prefix of relative data paths; empty: $MODEBANK_DATA, else this file's folder",
           MODEBANK_FIELD(data.root))
          .touch("when the data lie elsewhere than the configuration, or move between machines"),
      text("data.inputs", "a path with at most one *, or paths",
           "one file per run, which the part matched by * names, else the stem; a + b: parts of one recording",
           MODEBANK_FIELD(data.inputs))
          .touch("always: without it there is nothing to read", data, basic),
      text("data.states", "a path with at most one *, or paths",
           "the runs' states files; empty: states are columns of the inputs files", MODEBANK_FIELD(data.states))
          .touch("when what was measured and what was commanded are in different files", data, basic),
      text("data.state", "column names", "measured states", MODEBANK_FIELD(data.state))
          .touch("always: it is what the model predicts", data, basic),
      text("data.input", "column names", "inputs", MODEBANK_FIELD(data.input))
          .touch("always, unless the system moves without any input", data, basic),
      lines("data.derive", "NAME [unit] = EXPRESSION",
            "a channel computed of others: + - * / ^, comparisons, && ||, A ? B : C, sin ... atan2 sqrt abs min max, "
            "diff (per second), unwrap, yaw(x, y, z, w), rotate_x, _y, _z(roll, pitch, yaw, x, y, z); names that are "
            "no identifiers in 'single quotes'",
            check_derived, MODEBANK_FIELD(data.derive))
          .touch("when a channel is not in the log as you need it: a yaw rate from a quaternion, another unit", data,
                 basic),
      text("data.where", "an expression",
           "samples at which it is false or missing are left out: a gap that splits the run; empty: none",
           MODEBANK_FIELD(data.where))
          .touch("when parts of a log do not belong to it: handling by people, a fault, a switched-off motor", data),
      text("data.truth", "column names", "true states, one per state, where known; empty: none",
           MODEBANK_FIELD(data.truth))
          .touch("only for simulated data or an external reference (motion capture): it is compared, never learned",
                 data),
      text("data.weight", "a column name",
           "sample weights >= 0 of the transitions that end in each sample, 0 leaves one out; empty: all equal",
           MODEBANK_FIELD(data.weight))
          .touch("never, unless some samples are known to be worth less than others", data),
      text("data.label", "a column name",
           "what is known of each sample, as the ground: text or whole numbers, the last one holds; compared with the "
           "modes, /evaluation/confusion. Empty: none",
           MODEBANK_FIELD(data.label))
          .touch("when a column of the log holds the ground, gear or floor: modes are named after it and compared with "
                 "it",
                 data, basic),
      text("data.state_unit", "units", "one per state, or one for all; written to the archive and the plots",
           MODEBANK_FIELD(data.state_unit))
          .touch("when the log has no units, so that plots and exported filters have them", data),
      text("data.input_unit", "units", "one per input, or one for all", MODEBANK_FIELD(data.input_unit))
          .touch("when the log has no units; export to ros2 looks for m/s and rad/s", data),
      text("data.time", "one column name, or two of a stamp in two parts",
           "times: numbers or text. Of a recording: time is the header's stamp or, where there is none, when it was "
           "received; receive_time the latter. Empty: row k is at k / rate_hz",
           MODEBANK_FIELD(data.time))
          .touch("when the column of times has another name, or of a recording the receive time is the better one",
                 data, basic),
      words("data.time_unit",
            "what times count; auto: as their name, their size or how far apart they are shows, else seconds",
            MODEBANK_FIELD(data.time_unit))
          .touch("when durations on the screen are off by 60, a thousand or a million", data),
      time_format_option().touch(
          "when a message shows a time that it cannot read, or whose day and month may be swapped", data),
      words("data.separator", "what is between the fields of text files; auto: what their first rows show",
            MODEBANK_FIELD(data.format.separator))
          .touch("never, unless a text file is read wrongly: a mixture of separators cannot be told", data),
      words("data.decimal", "the decimal mark of text files; auto: as their first rows show",
            MODEBANK_FIELD(data.format.decimal))
          .touch("never, unless numbers with a decimal comma are read wrongly", data),
      text("data.na", "words",
           "words that stand for a missing value in text files, beside empty fields and NaN, in any case; numbers such "
           "as -999 by value",
           MODEBANK_FIELD(data.format.na))
          .touch("when your logger writes a word or a number of its own, such as -999, where nothing was measured",
                 data),
      skip_rows_option().touch("when a text file has a title above its table; `modebank init` finds the number", data),
      words("data.header",
            "whether text files' first row names the columns; if not they are c1, c2, ...; auto: whether it holds "
            "numbers",
            MODEBANK_FIELD(data.format.header))
          .touch("when the first row of a text file is taken for names and is not, or the other way round", data),
      text("data.definitions", "a folder",
           "of .msg files, for messages of ROS 2 whose types neither the recording nor this program defines; empty: "
           "none",
           MODEBANK_FIELD(data.format.definitions))
          .touch("when a ROS 2 .db3 recording has messages of your own types", data),
      words("data.join", "how states join the inputs: interpolated at the inputs' times, or row by row",
            MODEBANK_FIELD(data.join))
          .touch("row, when both files were written row by row together and their times cannot be trusted", data),
      text("data.run", "a column name", "column whose value separates runs inside one file; empty: one run per file",
           MODEBANK_FIELD(data.run))
          .touch("when one file holds several runs", data),
      numeric(
          "data.rate_hz", at_least(0), "Hz",
          "0: the inputs' own times; else resample: states linear, inputs held; below the log's rate, what moves at "
          "each sample is averaged over the step that ends at the new one",
          MODEBANK_FIELD(data.rate_hz))
          .touch("when `modebank check` suggests a rate: times jitter, or values only repeat between samples", data,
                 basic),
      lag_option().touch("auto, when states and inputs come from two instruments; a number, when you know it", data,
                         basic),
      numeric("data.lag_range_s", above(0), "s",
              "lags from minus to plus this are searched by lag_s = auto and by check",
              MODEBANK_FIELD(data.lag_range_s))
          .touch("when the lag is said to lie at the edge of the range", data),
      quantum_option().touch(
          "auto, when the finding says that measurements come in steps too coarse to compare densities", data),
      words("data.missing",
            "NaN, infinite or empty values: an error; a gap that splits the run; or a missing state is a step of "
            "prediction only, a missing input the last known one",
            MODEBANK_FIELD(data.missing))
          .touch("when reading stops at a missing value: gap if samples are lost, predict if single values are", data),
      words("data.disorder",
            "time going backwards or repeated: an error, or sort the rows and keep the first of each time",
            MODEBANK_FIELD(data.disorder))
          .touch("sort, when reading stops at times that go backwards and the logger is to blame", data),
      split_option().touch("when there is one long run: only what is held out can be evidence", data, basic),
      text("data.train", "run names", "training runs; empty: positions 0, 2, 4, ... in name order",
           MODEBANK_FIELD(data.train))
          .touch("when some runs must train (those that excite well), or must not", data),
      text("data.test", "run names", "held-out runs; empty: all that do not train", MODEBANK_FIELD(data.test))
          .touch("when the held-out runs must be particular ones: another day, another ground", data, basic),
  };
}

}  // namespace modebank::app
