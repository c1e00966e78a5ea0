#include "app/report/report_options.hpp"

#include "app/option_builders.hpp"

namespace modebank::app {

std::vector<Option> report_options() {
  return {
      numeric("report.size_mb", between(8, 2000), "MB",
              "largest page; what would exceed it is drawn by minima and maxima of more samples, and the page says so",
              MODEBANK_FIELD(report.size_mb)),
      numeric("report.runs", between(0, 10000), "",
              "a study's best runs that get pages of their own, in a folder beside the study's page",
              MODEBANK_FIELD(report.runs)),
      text("report.figures", "a folder", "figures for papers are written there as SVG (needs gnuplot)",
           MODEBANK_FIELD(report.figures)),
      flag("report.png", "figures as PNG, too", MODEBANK_FIELD(report.png)),
      flag("report.sources", "the figures' gnuplot scripts and data beside them, to restyle",
           MODEBANK_FIELD(report.sources)),
      text("report.run", "a run's name", "whose time series the figures draw; empty: the first that was held out",
           MODEBANK_FIELD(report.run)),
  };
}

}  // namespace modebank::app
