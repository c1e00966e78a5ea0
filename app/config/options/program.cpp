#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"

namespace modebank::app {

std::vector<Option> archive_options() {
  using enum Stage;
  return {
      text("archive.output", "a path", "archive to write; empty: this file's name with .h5, in the current folder",
           MODEBANK_FIELD(archive.output))
          .touch("for another name or folder", std::nullopt, basic),
      text("archive.bank", "an archive", "archive whose banks are judged; no new ones are learned",
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
  };
}

std::vector<Option> report_options() {
  return {
      numeric("report.size_mb", between(8, 2000), "MB",
              "largest size of a page. Longer plots are drawn by minima and maxima over more samples, with a note on "
              "the page",
              MODEBANK_FIELD(report.size_mb))
          .touch("larger, to show more samples of long runs; 8, to send the page by mail"),
  };
}

}  // namespace modebank::app
