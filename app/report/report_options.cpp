#include "app/report/report_options.hpp"

#include "app/option_builders.hpp"

namespace modebank::app {

std::vector<Option> report_options() {
  return {
      numeric("report.size_mb", between(8, 2000), "MB",
              "largest page; what would exceed it is drawn by minima and maxima of more samples, and the page says so",
              MODEBANK_FIELD(report.size_mb)),
  };
}

}  // namespace modebank::app
