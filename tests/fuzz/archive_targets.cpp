// Archives, plans of studies and their tables, with the hash that their content has.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/config/config_file.hpp"
#include "app/report/page/run_page.hpp"
#include "app/study/answers/verify_study.hpp"
#include "app/study/space/study_plan.hpp"
#include "app/text/first_screen.hpp"
#include "app/text/free_run_text.hpp"
#include "app/text/mode_words.hpp"
#include "app/text/summary_tables.hpp"
#include "app/text/summary_text.hpp"
#include "filter/step/bank_filter.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/archive/inspect.hpp"
#include "io/archive/study_file.hpp"
#include "io/files/sha256.hpp"
#include "modebank/base/error.hpp"
#include "tests/fuzz/mutate_hdf5.hpp"
#include "tests/fuzz/read_table.hpp"
#include "tests/fuzz/scratch.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/io/archive/archive_fixture.hpp"

namespace modebank::fuzz {

namespace {

std::vector<std::string> archives() {
  const std::filesystem::path path = scratch("seed_archive.h5");
  std::vector<std::string> seeds;
  const auto add = [&](Archive archive) {
    archive.config = app::resolved_text({});
    write_archive(path, archive);
    seeds.push_back(content_of(path));
  };
  Archive archive = test::full_archive(1, 1);
  add(archive);
  add(test::full_archive(2, 1));
  archive.evaluations.clear();
  archive.residual_tests.clear();
  add(archive);
  archive.mixture.reset();
  archive.windows.reset();
  add(archive);
  return seeds;
}

/// All that `show` prints of an archive.
std::size_t shown(const Archive& archive, const std::string& file) {
  constexpr int width = 100;
  std::string text =
      app::provenance_text(archive) + app::summary_text(archive, width) + app::free_run_text(archive, width);
  if (app::has_first_screen(archive))
    text += app::first_screen(archive, app::resolved_values(archive.config), file, width);
  if (archive.windows) text += app::window_parameters_text(archive, width);
  if (archive.mixture) text += app::candidates_text(*archive.mixture, width);
  if (archive.bank) text += app::modes_text(archive, true, width);
  text += app::modes_in_words(archive, width) + app::mode_diagnostics_text(archive, width);
  return text.size();
}

/// `track`: the bank at work, where the archive holds one that a filter takes.
void track(const std::filesystem::path& file) {
  const Bank bank = load_bank(file);
  BankFilter filter(bank, {});
  for (int k = 0; k < 3; ++k)
    filter.step(0.1 * k, Eigen::VectorXd::Constant(bank.structure.inputs, 0.1),
                Eigen::VectorXd::Constant(bank.C.rows(), 0.2));
}

/// verify, show, show --json, report and track. What verify accepts is read.
void use_archive(std::string_view bytes) {
  Random chances = chances_of(bytes);
  const std::filesystem::path file = scratch_file("fuzz_archive.h5", bytes);
  const bool accepted = verify_archive(file).ok();
  Archive archive;
  try {
    archive = read_archive(file);
  } catch (const DataError& error) {
    if (accepted) throw std::logic_error(fmt::format("verify accepts it, reading does not: {}", error.what()));
    throw;
  }
  if (!accepted) throw std::logic_error("it is read, but verify does not accept it");
  shown(archive, file.string());
  app::stored_config(archive.config, {});
  if (chances.one_in(4)) inspect(file, "/").dump();
  if (chances.one_in(8)) app::report::html_of(app::report::run_page(archive, "fuzz.h5", {}));
  read_trial_scores(file);
  track(file);
}

app::StudyPlan some_plan() {
  app::StudyPlan plan;
  plan.config = app::resolved_text({});
  plan.provenance.modebank_version = "1";
  plan.table.varied_keys = {"mixture.components", "window.length"};
  for (std::int64_t i = 0; i < 3; ++i) {
    app::TrialRow row;
    row.key = sha256_hex(std::to_string(i));
    row.varied = {std::to_string(i + 1), "10"};
    row.repeat = i;
    row.seed = 7;
    plan.table.rows.push_back(row);
  }
  plan.table.rows.back().status = app::TrialStatus::dropped;
  plan.table.rows.back().message = "why";
  return plan;
}

/// A study's folder that holds this plan, the table of what was done and one trial.
void use_plan(std::string_view bytes) {
  const std::filesystem::path folder = scratch("study");
  static const bool made = [&] {
    std::filesystem::create_directories(folder / "trials");
    write_archive(app::trial_archive(folder, sha256_hex("0")), test::full_archive(1, 1));
    return true;
  }();
  static_cast<void>(made);
  scratch_file("study/plan.h5", bytes);
  app::verify_study(folder);
  const app::StudyPlan plan = app::read_plan(folder);
  app::resolved_config(plan.config);
}

std::string make_plan(Random& random) {
  static const std::string seed = [] {
    app::write_plan(scratch(""), some_plan());
    return content_of(scratch("plan.h5"));
  }();
  return mutated_archive(random, seed);
}

}  // namespace

std::vector<Target> archive_targets() {
  constexpr std::uint64_t inputs = 100'000;
  return {{"archive", inputs,
           [](Random& random) {
             static const std::vector<std::string> seeds = archives();
             return mutated_archive(random, random.pick(seeds));
           },
           use_archive},
          {"plan", inputs, make_plan, use_plan}};
}

}  // namespace modebank::fuzz
