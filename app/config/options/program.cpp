#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"

namespace modebank::app {

std::vector<Option> archive_options() {
  using enum Stage;
  return {
      text("archive.output", "a path", "archive to write; empty: this file's name with .h5, in the current folder",
           MODEBANK_FIELD(archive.output))
          .touch("for another name or folder", std::nullopt, basic),
      text("archive.input", "an archive", "archive with the earlier stages, for `identify`, `cluster` and `evaluate`",
           MODEBANK_FIELD(archive.input))
          .touch("when windows or a mixture exist in an archive and only later stages change", std::nullopt, basic),
      text("archive.bank", "an archive", "archive whose banks `evaluate` judges; it learns no new ones",
           MODEBANK_FIELD(archive.bank))
          .touch("to judge an existing bank on other runs"),
      numeric("job.threads", between(0, 1024), "", "number of threads; 0: all cores. It never changes a result",
              MODEBANK_FIELD(job.threads))
          .touch("fewer, on a shared machine", std::nullopt, basic),
      option("job.seed", "a whole number >= 0", "", "seed of all random numbers", MODEBANK_FIELD(job.seed))
          .touch("to see how much a result depends on chance: repeat with 1, 2 and 3", mixture, basic),
  };
}

std::vector<Option> track_options() {
  return {
      words("track.filter",
            "filter of the archive that runs; combined: all of them, each weighted by its log score so far",
            MODEBANK_FIELD(track.filter))
          .touch("when the screen recommends another filter: that one", std::nullopt, basic),
      text("track.checkpoint", "a path", "file for the filter's state, written at the end of the input and on SIGINT",
           MODEBANK_FIELD(track.checkpoint))
          .touch("when the filter must continue after a restart", std::nullopt, basic),
      numeric("track.checkpoint_interval", at_least(0), "samples",
              "samples between two writes of the checkpoint; 0: at the end only",
              MODEBANK_FIELD(track.checkpoint_interval))
          .touch("with track.checkpoint, when power may fail: 1000"),
      text("track.resume", "a checkpoint", "checkpoint to continue from", MODEBANK_FIELD(track.resume))
          .touch("after a restart: the path of track.checkpoint", std::nullopt, basic),
      flag("track.forecast",
           "whether output lines also contain a forecast to the newest sample, where estimates wait for late inputs "
           "(data.lag_s below 0)",
           MODEBANK_FIELD(track.forecast))
          .touch("when inputs come late and you need the state of now"),
      numeric("track.watchdog_s", between(0, 86400), "s",
              "period of a status line on standard error: samples since the last one, the longest delay of an "
              "estimate, and mode probabilities. It comes without input, too; 0: never",
              MODEBANK_FIELD(track.watchdog_s))
          .touch("when the filter runs unattended: 60"),
  };
}

std::vector<Option> report_options() {
  return {
      numeric("report.size_mb", between(8, 2000), "MB",
              "largest size of a page. Longer plots are drawn by minima and maxima over more samples, with a note on "
              "the page",
              MODEBANK_FIELD(report.size_mb))
          .touch("larger, to show more samples of long runs; 8, to send the page by mail"),
      numeric("report.runs", between(0, 10000), "",
              "number of a study's best runs that get pages of their own, in a folder beside the study's page",
              MODEBANK_FIELD(report.runs))
          .touch("0, when the study's page is enough; more, to look into many runs"),
  };
}

}  // namespace modebank::app
