#include "app/chain/stage_key.hpp"

#include <bit>
#include <concepts>
#include <type_traits>
#include <utility>

#include "app/chain/build_info.hpp"
#include "io/files/sha256.hpp"

// All fields of a struct. The structured binding lists every field, so code that misses a field does not compile.
#define MODEBANK_KEY_FIELDS(Struct, ...)            \
  void add(KeyText& key, const Struct& fields_of) { \
    const auto& [__VA_ARGS__] = fields_of;          \
    key.fields(__VA_ARGS__);                        \
  }

namespace modebank {
namespace {

/// Appends values one after another. Different sequences of values always give different texts.
class KeyText {
 public:
  template <class... T>
  void fields(const T&... values) {
    (put(values), ...);
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;

  void put(const std::string& value) { text_ += std::to_string(value.size()) + ":" + value; }
  void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }
  template <std::integral T>
  void put(T value) {
    text_ += std::to_string(value) + ",";
  }
  template <class E>
  requires std::is_enum_v<E>
  void put(E value) { put(static_cast<std::int64_t>(value)); }
  void put(const InputDelays& value) { put(value.listed()); }
  template <class T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  template <class T>
  void put(const std::vector<T>& values) {
    put(values.size());
    for (const T& value : values) put(value);
  }
  template <class T, std::size_t size>
  void put(const std::array<T, size>& values) {
    for (const T& value : values) put(value);
  }
  template <class T>
  requires std::is_aggregate_v<T>
  void put(const T& value);
};

MODEBANK_KEY_FIELDS(FormatOptions, separator, decimal, header, na, skip_rows, skip_automatic, definitions)
MODEBANK_KEY_FIELDS(SplitOptions, kind, blocks, last_percent, gap_samples)
MODEBANK_KEY_FIELDS(DataOptions, root, inputs, states, state, input, truth, derive, where, state_unit, input_unit,
                    label, time, time_unit, time_format, join, run, rate_hz, lag_s, lag_auto, quantum, quantum_auto,
                    format, missing, disorder, split, train, test)
MODEBANK_KEY_FIELDS(FitOptions, model, state_lags, input_lags, input_delay, wheel_radius_m, length, step, loss,
                    loss_scale, sigma, prior, prior_sd, intercept, centre, covariance, max_iterations, solver, seed)
MODEBANK_KEY_FIELDS(EmOptions, covariance, restarts, split_merge, tolerance, max_iterations, covariance_floor,
                    noise_component)
MODEBANK_KEY_FIELDS(SelectionOptions, components, em)
MODEBANK_KEY_FIELDS(ClusterOptions, selection, features, windows, over_switch, error_aware)
MODEBANK_KEY_FIELDS(RefineOptions, max_iterations, tolerance, restarts, most_modes, folds, measurement_noise, screen,
                    state_dependent_transition, seed, transitions)
MODEBANK_KEY_FIELDS(BankOptions, theta, transition, stay, process_variance, measurement_variance, screen, refine, em)
MODEBANK_KEY_FIELDS(FilterOptions, variant)
MODEBANK_KEY_FIELDS(FreeRunOptions, samples, paths, seed)
MODEBANK_KEY_FIELDS(ScoringOptions, horizon, free_run, seed)

MODEBANK_KEY_FIELDS(SearchedLags, state, input, delay, most_samples)
MODEBANK_KEY_FIELDS(DataInputs, data)
MODEBANK_KEY_FIELDS(MixtureInputs, window, mixture, seed)
MODEBANK_KEY_FIELDS(StageLags, state_lags, input_lags, input_delay)
MODEBANK_KEY_FIELDS(ArmaxOrder, differences, state_lags, input_lags, noise_lags, intercept)
MODEBANK_KEY_FIELDS(ArmaxStructure, order, delays)
MODEBANK_KEY_FIELDS(OtherLags, linear, one_motion, drifting, armax)
MODEBANK_KEY_FIELDS(CompetitorInputs, window, terms, em, lags, measurement_variance, all)
MODEBANK_KEY_FIELDS(BankInputs, window, bank, lags, horizon, simulate, filter, one_model, one_motion, drifting,
                    terms_stated)
MODEBANK_KEY_FIELDS(StructureInputs, searched, window, with_modes)
MODEBANK_KEY_FIELDS(CompetitorScoreInputs, window, scoring)
MODEBANK_KEY_FIELDS(BankScoreInputs, filter, scoring)

template <class T>
requires std::is_aggregate_v<T>
void KeyText::put(const T& value) { add(*this, value); }

/// `earlier`: texts of the earlier results that the stage uses.
template <class Inputs, class... Earlier>
std::string key_of(Stage stage, const Inputs& inputs, const Earlier&... earlier) {
  KeyText key;
  key.fields(std::string(build_info::version), std::string(build_info::git_revision), std::string(name_of(stage)),
             inputs, earlier...);
  return sha256_hex(key.text());
}

}  // namespace

ScoringOptions scoring_inputs(const ChainOptions& options) {
  ScoringOptions scoring = options.scoring;
  scoring.seed = scoring.free_run.seed = options.seed;
  return scoring;
}

ChainInputs chain_inputs(const ChainOptions& options) {
  LearningInputs learning = learning_inputs(options);
  const ScoringOptions scoring = scoring_inputs(options);
  const FitOptions window = learning.windows;
  return {std::move(learning), {options.data}, {window, scoring}, {options.filter, scoring}};
}

StageKeys stage_keys(const ChainInputs& inputs, const std::string& data_hash) {
  using enum Stage;
  StageKeys keys;
  const auto key = [&](Stage stage) -> std::string& { return keys[index_of(stage)]; };
  key(data) = key_of(data, inputs.data, data_hash);
  key(structure) = key_of(structure, inputs.structure, key(data));
  key(windows) = key_of(windows, inputs.windows, key(data));
  key(mixture) = key_of(mixture, inputs.mixture, key(windows));
  key(competitors) = key_of(competitors, inputs.competitors, key(mixture));
  key(bank) = key_of(bank, inputs.bank, key(mixture), key(competitors));
  key(competitor_scores) = key_of(competitor_scores, inputs.competitor_scores, key(bank));
  key(bank_scores) = key_of(bank_scores, inputs.bank_scores, key(bank));
  return keys;
}

}  // namespace modebank
