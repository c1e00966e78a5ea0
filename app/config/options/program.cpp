#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"

namespace modebank::app {

std::vector<Option> archive_options() {
  using enum Stage;
  return {
      text("archive.output", "a path", "archive to write; empty: this file's name with .h5, in the current folder",
           MODEBANK_FIELD(archive.output))
          .touch("when the archive shall have another name or place than the configuration's", std::nullopt, basic),
      text("archive.input", "an archive", "supplies the earlier stages of identify, cluster and evaluate",
           MODEBANK_FIELD(archive.input))
          .touch("when windows or a mixture were archived before and only later stages change", std::nullopt, basic),
      text("archive.bank", "an archive", "evaluate: its banks are run instead of learning new ones",
           MODEBANK_FIELD(archive.bank))
          .touch("when a bank that exists is judged on other runs"),
      numeric("job.threads", between(0, 1024), "", "0: all cores; never changes a number", MODEBANK_FIELD(job.threads))
          .touch("when the machine is shared: fewer", std::nullopt, basic),
      option("job.seed", "a whole number >= 0", "", "the one seed; every use of randomness derives from it",
             MODEBANK_FIELD(job.seed))
          .touch("to see how much of a result is luck: repeat with three other seeds", mixture, basic),
  };
}

std::vector<Option> track_options() {
  return {
      words("track.filter",
            "which of the archive's filters runs; combined: all, their predictions weighted by how well each has "
            "predicted so far",
            MODEBANK_FIELD(track.filter))
          .touch("when the finding names a simpler description: that one", std::nullopt, basic),
      text("track.checkpoint", "a path", "where the filter's state is kept at the end of the input or on SIGINT",
           MODEBANK_FIELD(track.checkpoint))
          .touch("when the filter must go on after a restart as if there had been none", std::nullopt, basic),
      numeric("track.checkpoint_interval", at_least(0), "samples", "and this often; 0: at the end only",
              MODEBANK_FIELD(track.checkpoint_interval))
          .touch("with a checkpoint: when power may fail"),
      text("track.resume", "a checkpoint", "go on from there", MODEBANK_FIELD(track.resume))
          .touch("after a restart: the checkpoint that was kept", std::nullopt, basic),
      flag("track.forecast",
           "lines also have what is expected at the time of the newest sample, where estimates wait for inputs that "
           "come "
           "late (data.lag_s below 0)",
           MODEBANK_FIELD(track.forecast))
          .touch("when inputs come late and the state of now is wanted"),
      numeric("track.watchdog_s", between(0, 86400), "s",
              "this often a line on standard error says what came, how late the slowest estimate was and how likely "
              "the modes are, also when no input comes; 0: never",
              MODEBANK_FIELD(track.watchdog_s))
          .touch("when the filter runs unattended and someone reads its log"),
  };
}

std::vector<Option> report_options() {
  return {
      numeric("report.size_mb", between(8, 2000), "MB",
              "largest page; what would exceed it is drawn by minima and maxima of more samples, and the page says so",
              MODEBANK_FIELD(report.size_mb))
          .touch("when the page of long runs must show more samples, or must be sent by mail"),
      numeric("report.runs", between(0, 10000), "",
              "a study's best runs that get pages of their own, in a folder beside the study's page",
              MODEBANK_FIELD(report.runs))
          .touch("0, when a study's page alone is enough; more, when you look into many runs"),
  };
}

}  // namespace modebank::app
