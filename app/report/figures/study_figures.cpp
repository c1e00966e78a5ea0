#include <algorithm>
#include <limits>

#include "app/report/page/assets.hpp"
#include "app/report/page/study_page.hpp"
#include "app/study/answers/answers.hpp"

namespace modebank::app::report {
namespace {

constexpr const char* components_key = "mixture.components";
constexpr double percent_of_share = 100.0;

/// Mean over the runs with that value; NaN without any. An empty value: the first there is.
double effect(const Answers& answers, const std::string& value, const std::string& score) {
  for (const MainEffect& effect : answers.main_effects)
    if (effect.key == components_key && effect.score == score && (value.empty() || effect.value == value))
      return percent_of_share * effect.mean;
  return std::numeric_limits<double>::quiet_NaN();
}

/// Values of the number of components in the order of the plan.
std::vector<std::string> component_counts(const Answers& answers) {
  std::vector<std::string> counts;
  for (const MainEffect& effect : answers.main_effects)
    if (effect.key == components_key && std::find(counts.begin(), counts.end(), effect.value) == counts.end())
      counts.push_back(effect.value);
  return counts;
}

}  // namespace

FigureSet study_figures(const StudyTable& table) {
  FigureSet set;
  const Answers answers = answer(table);
  const std::vector<std::string> counts = component_counts(answers);
  if (counts.empty()) {
    set.left_out.emplace_back("coverage over K: the study does not vary mixture.components, or no run has finished");
    return set;
  }
  struct Bar {
    std::string title, filter, value;
  };
  std::vector<Bar> bars{{"baseline", "baseline", ""},
                        {"noise only", "noise_only", ""},
                        {"one motion", "one_motion", ""},
                        {"drifting", "drifting", ""}};
  for (const std::string& count : counts) bars.push_back({"K = " + count, "bank", count});
  Figure figure("coverage", assets::figure_coverage());
  std::vector<std::string> titles;
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(bars.size()), 5);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Bar& bar = bars[static_cast<std::size_t>(i)];
    titles.push_back(bar.title);
    const auto share = [&](const char* score) { return effect(answers, bar.value, bar.filter + score); };
    rows.row(i) << static_cast<double>(i + 1), share("_train_nis_above"), share("_train_nis_below"),
        share("_test_nis_above"), share("_test_nis_below");
  }
  figure.set("filters", rows.rows());
  figure.set("filter_title", titles);
  figure.add_block("NIS outside its 95 % interval [%], mean over the runs with that K",
                   {"position", "train above", "train below", "test above", "test below"}, rows);
  set.figures.push_back(std::move(figure));
  return set;
}

}  // namespace modebank::app::report
