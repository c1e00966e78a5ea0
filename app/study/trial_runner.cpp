#include "app/study/trial_runner.hpp"

#include <chrono>

#include "app/config_file.hpp"
#include "app/provenance.hpp"

namespace modebank::app {

const Archive& TrialRunner::run(const Config& config, const CommandLine& line) {
  seconds_.fill(0.0);
  wanted_[0] = stage_inputs(TrialStage::data, config, "");
  renew(TrialStage::data, [&] {
    import_stage(config, archive_);
    imported_ = archive_.provenance;
  });
  for (std::size_t i = 1; i < trial_stage_count; ++i)
    wanted_[i] = stage_inputs(static_cast<TrialStage>(i), config, imported_.data_hash);
  archive_.config = resolved_text(config);
  archive_.provenance = make_provenance(config, line);
  archive_.provenance.data_hash = imported_.data_hash;
  archive_.provenance.inputs = imported_.inputs;
  learn(config);
  score(config);
  return archive_;
}

void TrialRunner::renew(TrialStage stage, const std::function<void()>& make) {
  const auto i = static_cast<std::size_t>(stage);
  if (held_[i] == wanted_[i]) return;
  held_[i].clear();  // if `make` throws, what is there belongs to no trial
  const auto start = std::chrono::steady_clock::now();
  make();
  seconds_[i] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  held_[i] = wanted_[i];
}

void TrialRunner::share(TrialStage stage, const std::function<void()>& compute, const std::function<Archive()>& part,
                        const std::function<void(Archive&&)>& take) {
  constexpr double worth_a_file_s = 0.2;
  renew(stage, [&] {
    if (!cache_) return compute();
    cache_->provide(
        std::string(name_of(stage)), wanted_[static_cast<std::size_t>(stage)], take,
        [&] {
          const auto start = std::chrono::steady_clock::now();
          compute();
          const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
          return stage == TrialStage::windows || took.count() > worth_a_file_s;
        },
        part);
  });
}

void TrialRunner::learn(const Config& config) {
  share(
      TrialStage::windows, [&] { identify_stage(config, archive_); },
      [&] {
        Archive part;
        part.recording = archive_.recording;
        part.windows = archive_.windows;
        return part;
      },
      [&](Archive&& part) { archive_.windows = std::move(part.windows); });
  renew(TrialStage::competitors, [&] { competitors_stage(config, archive_); });
  share(
      TrialStage::mixture, [&] { cluster_stage(config, archive_); },
      [&] {
        Archive part;
        part.mixture = archive_.mixture;
        return part;
      },
      [&](Archive&& part) { archive_.mixture = std::move(part.mixture); });
  archive_.provenance.inputs = imported_.inputs;  // whether or not the mixture was computed here
  if (!config.mixture.start_file.empty())
    archive_.provenance.inputs.push_back(describe_file(config.mixture.start_file));
  share(
      TrialStage::bank, [&] { modes_stage(config, archive_); },
      [&] {
        Archive part;
        part.bank = archive_.bank;
        part.unrefined = archive_.unrefined;
        part.merging = archive_.merging;
        part.measured_fit = archive_.measured_fit;
        return part;
      },
      [&](Archive&& part) {
        archive_.bank = std::move(part.bank);
        archive_.unrefined = std::move(part.unrefined);
        archive_.merging = std::move(part.merging);
        archive_.measured_fit = part.measured_fit;
      });
}

void TrialRunner::score(const Config& config) {
  const auto score_one = [&](const std::string& filter) {
    scores_[filter] = score_filter(config, archive_, filter);
    tests_[filter] = test_filter(archive_, scores_[filter].evaluation);
  };
  renew(TrialStage::competitor_scores, [&] {
    tests_["global"] = test_global(config, archive_);
    score_one("baseline");
    score_one("noise_only");
  });
  renew(TrialStage::bank_scores, [&] { score_one("bank"); });
  take_scores({scores_["bank"], scores_["baseline"], scores_["noise_only"]}, archive_);
  archive_.residual_tests.clear();
  for (const char* model : {"global", "bank", "baseline", "noise_only"})
    archive_.residual_tests.push_back(tests_[model]);
}

}  // namespace modebank::app
