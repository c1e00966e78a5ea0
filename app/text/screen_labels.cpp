#include "app/text/screen_labels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace modebank::app {

const std::vector<ScreenLabel>& screen_labels() {
  static const std::vector<ScreenLabel> labels{
      {"read",
       "the data: training runs, held-out runs and their steps, the states that the models predict, "
       "the inputs, and by how much stamps are late."},
      {"structure",
       "how many past samples of the states (state lags) and of the inputs (input lags) the models predict "
       "from, and how many samples an input waits before it acts (delay)."},
      {"finding",
       "whether switching between several linear models predicts the held-out runs better than the best "
       "single model does, by how much, and the standard error of that gain. A gain counts from 0.02 nats "
       "per sample on; beyond chance is more than about two standard errors."},
      {"modes",
       "one line per mode, the most used first: how much it is used, how long it lasts, how fast it answers and "
       "how far it follows each input."},
      {"band",
       "how many of the samples lie in the 95 % band that the bank predicts one step ahead, and at the longest "
       "horizon. Brackets: the 95 % interval of the share. Calibrated: 92.5 to 97.5 %, a mean NIS of 0.75 to 1.3 per "
       "state, and a correlation of neighbouring errors within 0.2."},
      {"mean",
       "how far the predicted mean is off (RMSE), one and several steps ahead. FIT of 100 % is perfect, 0 % is "
       "as good as the mean of the measurements. Brackets: the same of the best competitor, which the finding "
       "names, and of all filters combined."},
      {"warning", "a fact that limits the use of the result. `modebank show ARCHIVE` prints all warnings."},
      {"next", "what to do now, with the command to type. It begins with ready if nothing must be settled first."},
      {"use",
       "the model that explains the motion, and for each number of steps the simplest filter that predicts within "
       "0.02 nats of the best (chosen by training runs), with the name to give to --track.filter. Brackets: its gain "
       "over the finding's best competitor on the held-out runs, and the filter to take for `export --to c`."},
      {"archive", "the HDF5 file that holds the whole result; `modebank show` and `modebank report` read it."},
      {"log", "the files that `run LOG` reads."},
      {"time", "the column of times, the sampling rate and the duration."},
      {"state", "the columns that the models predict, with their unit."},
      {"inputs",
       "the columns that act on the states, with their unit; at the end of `show`, the number of files read."},
      {"runs", "how the log is cut into runs, and which of them are held out."},
      {"doubt",
       "a choice that the log does not settle: check it, and state the key in the configuration if it is wrong."},
      {"robot", "a correction that a filter on the robot must also make: turn a sensor, or delay one."},
      {"files", "the page and the configuration that `run LOG` writes beside the archive."},
      {"data", "the number of runs and steps and the sample period; at the top of `show`, the hash of the data."},
      {"lag",
       "by how much inputs act later or earlier than their stamps state, per run and on average, with standard "
       "errors, and which correction is applied. See also the term State lags."},
      {"windows", "how many windows were fitted, and how their fits ended."},
      {"global", "the linear model that is fitted to all training runs at once."},
      {"mixture",
       "the Gaussian mixture that the windows' parameters are clustered by: its components, BIC, and how many "
       "restarts agree."},
      {"bank", "the modes, the number of components that became modes, and the measurement noise R."},
      {"learned", "how many of the training steps the bank was learned from."},
      {"residuals",
       "how many autocorrelations and input correlations of the errors lie outside their bands: 5 % if the "
       "model is right."},
      {"modebank", "the version that wrote the archive, and when."},
      {"command", "the command line that made the archive."},
      {"config", "the hash of the configuration; the archive contains all of it."},
      {"built", "the versions of the libraries that the program was built with."},
      {"reads", "a file that the command would read (--dry-run)."},
      {"writes", "a file that the command would write (--dry-run)."}};
  return labels;
}

std::string padded_label(const std::string& name) {
  const std::vector<ScreenLabel>& labels = screen_labels();
  if (std::none_of(labels.begin(), labels.end(), [&](const ScreenLabel& label) { return label.name == name; }))
    throw std::logic_error("screen_labels has no " + name);
  return fmt::format("{:<10}", name);
}

}  // namespace modebank::app
