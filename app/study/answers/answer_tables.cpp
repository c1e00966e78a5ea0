#include "app/study/answers/answers_text.hpp"
#include "app/study/answers/merge_study.hpp"

namespace modebank::app {
namespace {

/// A column with the result of `value_of` for each element.
template <class T, class F>
NamedColumn column_from(const std::string& name, const std::vector<T>& elements, F value_of) {
  using Value = std::decay_t<decltype(value_of(elements.front()))>;
  using Stored = std::conditional_t<std::is_same_v<Value, int>, std::int64_t, Value>;
  std::vector<Stored> values;
  for (const T& element : elements) values.push_back(value_of(element));
  return {name, std::move(values)};
}

}  // namespace

std::vector<NamedTable> answer_tables(const StudyTable& table, const Answers& answers) {
  const auto trial_of = [&table](const auto& element) { return table.rows[element.row].key; };
  const auto setting_of = [&table](const auto& element) { return setting_text(table, element.row); };
  using E = MainEffect;
  using I = KeyInfluence;
  using B = BestSetting;
  return {{"main_effects",
           {column_from("key", answers.main_effects, [](const E& e) { return e.key; }),
            column_from("value", answers.main_effects, [](const E& e) { return e.value; }),
            column_from("score", answers.main_effects, [](const E& e) { return e.score; }),
            column_from("trials", answers.main_effects, [](const E& e) { return e.trials; }),
            column_from("mean", answers.main_effects, [](const E& e) { return e.mean; }),
            column_from("sd", answers.main_effects, [](const E& e) { return e.sd; }),
            column_from("best", answers.main_effects, [](const E& e) { return e.best; })}},
          {"influence",
           {column_from("key", answers.influences, [](const I& i) { return i.key; }),
            column_from("score", answers.influences, [](const I& i) { return i.score; }),
            column_from("share", answers.influences, [](const I& i) { return i.share; })}},
          {"best",
           {column_from("score", answers.best, [](const B& b) { return b.score; }),
            column_from("better", answers.best, [](const B& b) { return b.goal.text(); }),
            column_from("value", answers.best, [](const B& b) { return b.value; }),
            column_from("repeats", answers.best, [](const B& b) { return b.repeats; }),
            column_from("trial", answers.best, trial_of), column_from("setting", answers.best, setting_of)}}};
}

}  // namespace modebank::app
