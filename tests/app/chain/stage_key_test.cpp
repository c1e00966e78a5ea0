// If another value of a configuration key changes the output of a stage, the stage's key must also change. Otherwise
// trials of a study that share stages by key would differ from `run`.
// This test tries other values of every key of the option table. The first stage that changes must be the stage in the
// key's row.
#include "app/chain/stage_key.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include "app/chain/chain.hpp"
#include "app/chain/stages.hpp"
#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "io/files/read_file.hpp"
#include "io/files/sha256.hpp"
#include "tests/support/paths.hpp"

namespace modebank::app {
namespace {

using test::TemporaryFolder;
using test::write_file;

/// A scalar system in two blocks of time. It switches between three responses to its inputs.
std::string csv_run(unsigned seed) {
  std::mt19937_64 generator(seed);
  const auto uniform = [&] { return static_cast<double>(generator() >> 11) * 0x1p-53 - 0.5; };
  constexpr std::array<double, 3> gains{0.1, 0.5, 1.2};
  std::ostringstream text;
  text.precision(17);
  text << "time,clock,wz,other,left,right,weight,block\n";
  double wz = 0.0;
  for (int k = 0; k < 90; ++k) {
    const double left = uniform(), right = uniform();
    text << 0.1 * k << ',' << 0.12 * k << ',' << wz + 0.02 * uniform() << ',' << 0.9 * wz + 0.01 * uniform() << ','
         << left << ',' << right << ',' << 1.0 + 0.5 * uniform() << ',' << k / 45 << '\n';
    wz += -0.4 * wz + gains[k / 15 % 3] * (right - left) + 0.03 * uniform();
  }
  return text.str();
}

/// Computes every stage. Stores the key of each stage and the bytes of its part of the archive.
class Recorder : public StageSource {
 public:
  explicit Recorder(std::filesystem::path scratch) : scratch_(std::move(scratch)) {}
  void provide(Stage stage, const std::string& key, const StagePart& part) override {
    part.compute();
    Archive content = part.give();
    std::swap(content.provenance, provenance_);
    write_archive(scratch_, content);
    std::swap(content.provenance, provenance_);
    part.take(std::move(content));
    keys[index_of(stage)] = key;
    contents[index_of(stage)] = sha256_hex(read_file(scratch_));
  }
  StageKeys keys;
  std::array<std::string, stage_count> contents;

 private:
  std::filesystem::path scratch_;
  Provenance provenance_;  ///< filled only while a part is written
};

class StageKey : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { ::unsetenv("MODEBANK_DATA"); }  // the test's configuration contains all paths
  StageKey() {
    std::filesystem::create_directory(file("elsewhere"));
    for (unsigned run = 0; run < 3; ++run) {
      const std::string name = "run_0" + std::to_string(run) + ".csv";
      write_file(file(name), csv_run(run));
      write_file(file("elsewhere") / name, csv_run(run + 3));
    }
    write_file(
        file("base.ini"),
        "[data]\ninputs = run_*.csv\nstate = wz\ninput = left, right\n[window]\nmodel = linear\nlength = 10\nstep = 3\n"
        "[mixture]\ncomponents = 3\nrestarts = 2\nsplit_merge = 1\n");
  }

  std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  Config configured(const KeyValues& keys) const { return load_config(file("base.ini"), keys); }
  /// For any key, limits slow work that no key limits to the amount in `base`.
  static ChainOptions quick(const Config& config, const Config& base) {
    ChainOptions options = chain_options(config);
    options.bank.em.folds = 2;
    options.bank.em.max_iterations = most_components(base.mixture.selection) == 2 ? 6 : 2;
    return options;
  }
  Recorder recorded(const Config& config, const Config& base) const {
    Recorder recorder(file("part.h5"));
    const Listener silent;
    Chain(recorder, silent).run(quick(config, base), Stage::bank_scores, {});
    return recorder;
  }

 private:
  TemporaryFolder folder_;
};

const std::vector<KeyValues> bases{
    {{"mixture.components", "2"}, {"bank.refine", "none"}, {"filter.simulate", "5"}},
    {{"mixture.components", "2"}, {"bank.refine", "em"}},
    {{"window.model", "varx"}, {"mixture.components", "2"}},
    {{"bank.process_variance", "0.01"}, {"bank.transition", "stay"}},
};

/// Other values for keys whose range is not described by a rule.
const std::map<std::string, std::vector<std::string>> texts{
    {"data.root", {"elsewhere"}},
    {"data.inputs", {"run_0*.csv"}},
    {"data.states", {"run_*.csv"}},
    {"data.state", {"other"}},
    {"data.input", {"left"}},
    {"data.truth", {"other"}},
    {"data.derive", {"twice = 2 * wz"}},
    {"data.where", {"right > -0.4"}},
    {"data.label", {"block"}},
    {"bank.mode_names", {"ice, grip"}},
    {"data.state_unit", {"rad/s"}},
    {"data.input_unit", {"m/s"}},
    {"data.time", {"clock"}},
    {"data.run", {"block"}},
    {"data.split", {"blocks 2", "last 40 %"}},
    {"data.train", {"01"}},
    {"data.test", {"00"}},
    {"data.lag_s", {"0.1", "auto"}},
    {"data.na", {"nothing"}},
    {"data.skip_rows", {"auto"}},
    {"mixture.components", {"2", "1..3"}},
    {"window.prior", {"none", "0.3"}},
    {"job.seed", {"2", "3"}},
    {"filter.horizon", {"2", "1..3"}},
    {"window.state_lags", {"2", "auto"}},
    {"window.input_lags", {"2", "auto"}},
    {"window.input_delay", {"2", "1, 3", "auto"}},
    {"data.quantum", {"0.02", "auto"}},
};

/// Other values that the option accepts: words or a few numbers.
std::vector<std::string> others(const Option& option, const Config& base) {
  std::vector<std::string> candidates{"2", "0.5", "0", "7", "0.05", "1"};
  const auto text = texts.find(option.key);
  if (text != texts.end()) candidates = text->second;
  if (text == texts.end() && option.range.find(" | ") != std::string::npos) {
    candidates.clear();
    std::istringstream words(option.range);
    for (std::string word; words >> word;)
      if (word != "|") candidates.push_back(word);
  }
  std::vector<std::string> values;
  for (const std::string& candidate : candidates) try {
      Config other = base;
      option.set(other, candidate);
      if (option.get(other) != option.get(base)) values.push_back(candidate);
    } catch (const std::invalid_argument&) {
    }
  constexpr std::size_t numbers = 3;
  if (text == texts.end() && candidates.front() == "2" && values.size() > numbers) values.resize(numbers);
  return values;
}

struct Case {
  std::string name() const { return key + " = " + value + " (base " + std::to_string(base) + ")"; }

  std::size_t base;
  std::string key, value;
  std::string refusal = {};             ///< message of the exception; empty if the chain ran
  std::vector<std::string> stale = {};  ///< stages that changed although their keys stayed the same
  std::size_t first = stage_count;      ///< first stage whose numbers have changed
};

/// The exceptions that a chain may throw for a value. Any other exception is a failure of the test.
struct RuledOut {
  std::string key, reason;
};
const std::vector<RuledOut> ruled_out{
    {"data.rate_hz", "no training run has the 10 transitions of a window"},
    {"data.time_unit", "time goes backwards or repeats"},
    {"data.separator", "has no column"},
    {"data.decimal", "is not a number with a decimal comma"},
    {"data.header", "has no column"},
    {"window.model", "it fits linear modes"},
    {"window.state_lags", "need window.model = varx"},
    {"window.state_lags", "need model = varx"},
    {"window.input_lags", "need window.model = varx"},
    {"window.input_lags", "need model = varx"},
    {"window.input_delay", "need window.model = varx"},
    {"window.input_delay", "need model = varx"},
    {"bank.transition", "bank.transition = logit"},
    {"bank.process_variance", "does not work with bank.refine = em"},
    {"bank.refine", "does not work with bank.refine = em"},
};

/// Keys that can have only one value with these data.
const std::map<std::string, std::string> one_value{{"data.root", "it has one folder"},
                                                   {"data.time_format", "its times are seconds"}};

/// Keys that have no effect on these data. This test does not cover them.
const std::map<std::string, std::string> without_effect{
    {"data.states", "the other value names the same files"},
    {"data.derive", "no base uses what is derived"},
    {"data.definitions", "no file is a recording"},
    {"data.separator", "commas separate, and nothing else can be read"},
    {"data.decimal", "no number has a comma"},
    {"data.na", "no value is the word that is tried"},
    {"data.skip_rows", "no title stands above the table"},
    {"data.header", "the first row names the columns, and without it none is found"},
    {"data.join", "there are no states files to join"},
    {"data.missing", "nothing is missing"},
    {"data.disorder", "time is in order"},
    {"mixture.windows", "every choice takes the same windows (cause not looked into)"},
    {"mixture.straddling", "every choice treats all windows alike (cause not looked into)"},
    {"bank.mode_names", "people's names of what was learned are no stage's"},
};

/// A key that changes an earlier stage of other data.
constexpr const char* earlier_elsewhere = "bank.measurement_variance";  // the linear stage takes R; no base has noise

bool may_be_refused(const Case& c) {
  return std::any_of(ruled_out.begin(), ruled_out.end(), [&](const RuledOut& known) {
    return known.key == c.key && c.refusal.find(known.reason) != std::string::npos;
  });
}

bool is_tried(const Option& option) { return option.stage || option.key == "data.root"; }

/// A thousand chains take minutes. So the keys are split into parts that run in parallel.
constexpr std::size_t parts = 12;

std::vector<Option> keys_of(std::size_t part) {
  std::vector<Option> keys;
  std::size_t number = 0;
  for (const Option& option : option_table())
    if (is_tried(option) && number++ % parts == part) keys.push_back(option);
  return keys;
}

std::vector<Case> cases_of(const std::vector<Option>& keys, const std::vector<Config>& configs) {
  std::vector<Case> cases;
  for (std::size_t base = 0; base < configs.size(); ++base)
    for (const Option& option : keys)
      for (const std::string& value : others(option, configs[base])) cases.push_back({base, option.key, value});
  return cases;
}

class StageKeyPart : public StageKey, public ::testing::WithParamInterface<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Keys, StageKeyPart, ::testing::Range(std::size_t{0}, parts));

TEST_P(StageKeyPart, ChangesWhereverAnotherValueOfAKeyChangesTheStage) {
  std::vector<Config> configs;
  std::vector<Recorder> before;
  for (const KeyValues& keys : bases) {
    configs.push_back(configured(keys));
    before.push_back(recorded(configs.back(), configs.back()));
  }
  const std::vector<Option> keys = keys_of(GetParam());
  std::vector<Case> cases = cases_of(keys, configs);
  // The cases run one after another, because HDF5 refuses a second image in memory with the same name.
  for (Case& c : cases) try {
      Config config = configs[c.base];
      const std::string value = c.key == "data.root" ? file(c.value).string() : c.value;
      find_option(c.key)->set(config, value);
      validate(config);
      const Recorder now = recorded(config, configs[c.base]);
      for (std::size_t stage = 0; stage < stage_count; ++stage) {
        const bool other = now.contents[stage] != before[c.base].contents[stage];
        if (other) c.first = std::min(c.first, stage);
        if (other && now.keys[stage] == before[c.base].keys[stage])
          c.stale.emplace_back(name_of(static_cast<Stage>(stage)));
      }
    } catch (const std::exception& error) {
      c.refusal = error.what();
    }
  std::set<std::string> tried;
  std::map<std::string, std::size_t> effective;  // for each key, the first stage that changes
  for (const Case& c : cases) {
    if (c.refusal.empty()) tried.insert(c.key);
    if (c.first < stage_count) {
      const auto [known, fresh] = effective.emplace(c.key, c.first);
      known->second = std::min(known->second, c.first);
    }
    EXPECT_TRUE(c.refusal.empty() || may_be_refused(c)) << c.name() << ": " << c.refusal;
    for (const std::string& stage : c.stale) ADD_FAILURE() << c.name() << " changes " << stage << " but not its key";
  }
  for (const Option& option : keys)
    if (!one_value.contains(option.key)) {
      EXPECT_TRUE(tried.contains(option.key)) << option.key << ": no other value could be tried";
      EXPECT_NE(effective.contains(option.key), without_effect.contains(option.key))
          << option.key << (effective.contains(option.key) ? " has an effect after all" : " changed nothing");
      const auto first = effective.find(option.key);
      if (first == effective.end() || option.key == earlier_elsewhere) continue;
      EXPECT_EQ(name_of(static_cast<Stage>(first->second)), name_of(option.stage.value())) << option.key;
    }
}

TEST_F(StageKey, OfABankHoldsTheFilterOnlyWhereItIsRun) {
  const auto key = [&](const char* refine, const char* filter) {
    const Config config = configured({{"bank.refine", refine}, {"filter.variant", filter}});
    return stage_keys(chain_inputs(chain_options(config)), "data")[index_of(Stage::bank)];
  };
  EXPECT_NE(key("em", "imm"), key("em", "salvi2025"));
  EXPECT_EQ(key("none", "imm"), key("none", "salvi2025"));
  const auto automatic = [&](const char* model) {
    return chain_inputs(chain_options(configured({{"window.model", model}}))).bank.bank.refine;
  };
  EXPECT_EQ(automatic("linear"), Refine::em);
  EXPECT_EQ(automatic("icr"), Refine::none) << "shares its bank with what says none";
}

/// The choice of lags depends on how one model is fitted, but not on the bank.
TEST_F(StageKey, OfAStructureThatIsFoundHoldsHowOneModelIsFitted) {
  const auto options = [&](KeyValues keys) {
    keys.emplace_back("window.model", "varx");
    return chain_options(configured(keys));
  };
  const auto keys = [](const ChainOptions& of) { return stage_keys(chain_inputs(of), "data"); };
  const KeyValues found{{"window.state_lags", "auto"}};
  const auto counts = [&](const char* key, const char* value) {
    KeyValues other = found;
    other.emplace_back(key, value);
    return keys(options(other))[index_of(Stage::structure)];
  };
  const std::string base = keys(options(found))[index_of(Stage::structure)];
  EXPECT_EQ(counts("mixture.components", "2"), base);
  EXPECT_EQ(counts("window.length", "12"), base);
  EXPECT_NE(counts("window.loss", "trivial"), base);
  EXPECT_NE(counts("window.intercept", "true"), base);
  EXPECT_NE(counts("filter.simulate", "20"), base) << "which bounds the lags";
  EXPECT_NE(counts("window.input_lags", "2"), base);
  EXPECT_NE(counts("window.input_lags", "auto"), base);
  EXPECT_EQ(counts("filter.horizon", "2"), base);
  const auto of_found = [&](const FoundStructure& structure) {
    ChainOptions chain = options(found);
    static_cast<LearningOptions&>(chain) = with_structure(chain, structure, 1);
    return keys(chain);
  };
  const StageKeys two = of_found({2, 1});
  EXPECT_EQ(two[index_of(Stage::structure)], base) << "the result does not decide the search";
  EXPECT_EQ(two[index_of(Stage::windows)], keys(options({{"window.state_lags", "2"}}))[index_of(Stage::windows)]);
  EXPECT_NE(two[index_of(Stage::windows)], of_found({3, 1})[index_of(Stage::windows)]);
}

TEST_F(StageKey, HoldsTheContentOfTheData) {
  const auto keys = [&](const Config& config, const char* data_hash) {
    return stage_keys(chain_inputs(chain_options(config)), data_hash);
  };
  const Config config = configured({});
  const StageKeys a = keys(config, "a"), b = keys(config, "b");
  for (std::size_t stage = 0; stage < stage_count; ++stage) EXPECT_NE(a[stage], b[stage]);
}

}  // namespace
}  // namespace modebank::app
