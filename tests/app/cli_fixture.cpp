#include "tests/app/cli_fixture.hpp"

#include <algorithm>
#include <cstdlib>
#include <random>
#include <sstream>

namespace modebank::test {

CliTest::CliTest() {
  unsetenv("MODEBANK_DATA");  // the tests must not use the user's data folder
  write("run_00.csv", csv_run(80, 1));
  write("run_01.csv", csv_run(80, 2));
  write("test.ini", config_text());
}

const char* CliTest::config_text() {
  return "[data]\n"
         "inputs = run_*.csv\n"
         "state = wz\n"
         "input = left, right\n"
         "[window]\n"
         "model = linear\n"
         "[mixture]\n"
         "components = 1..2\n";
}

std::string CliTest::csv_run(int samples, unsigned seed) {
  std::mt19937_64 generator(seed);
  const auto uniform = [&generator] { return static_cast<double>(generator() >> 11) * 0x1p-53 - 0.5; };
  std::ostringstream text;
  text.precision(17);
  text << "time,wz,left,right\n";
  double wz = 0.0;
  for (int k = 0; k < samples; ++k) {
    const double left = uniform(), right = uniform();
    text << 0.1 * k << ',' << wz << ',' << left << ',' << right << '\n';
    wz += -0.4 * wz - 0.2 * left + 0.2 * right + 0.01 * uniform();
  }
  return text.str();
}

ProgramResult CliTest::modebank(std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(), MODEBANK_PROGRAM);
  return run_program(arguments);
}

ProgramResult CliTest::run(std::vector<std::string> options) const {
  // --force is needed, because tests change the runs and write the same archive again.
  std::vector<std::string> arguments{
      "run", config(), "--force", "--archive.output", archive(), "--data.root", folder_.path().string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return modebank(arguments);
}

std::vector<std::string> CliTest::left_behind() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    const std::string name = entry.path().filename().string();
    if (name != "test.ini" && name.rfind("run_", 0) != 0) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace modebank::test
