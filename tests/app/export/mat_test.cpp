// The MAT-file as other programs read it.
#include <gmock/gmock.h>
#include <matio.h>

#include <filesystem>
#include <memory>

#include "app/export/forms.hpp"
#include "ident/base/utf8.hpp"
#include "tests/app/export/exported.hpp"
#include "tests/app/export/hostile_names.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/run_program.hpp"

namespace modebank::app::test {
namespace {

using modebank::test::run_program;
using modebank::test::TemporaryFolder;
using ::testing::HasSubstr;

struct Opened {
  std::unique_ptr<mat_t, int (*)(mat_t*)> mat;
  explicit Opened(const std::filesystem::path& file) : mat(Mat_Open(file.c_str(), MAT_ACC_RDONLY), Mat_Close) {}
  std::unique_ptr<matvar_t, void (*)(matvar_t*)> at(const char* name) const {
    return {Mat_VarRead(mat.get(), name), Mat_VarFree};
  }
  Eigen::VectorXd numbers(const char* name) const {
    const auto variable = at(name);
    if (!variable || variable->data_type != MAT_T_DOUBLE) return {};
    const auto count = static_cast<Index>(variable->nbytes / sizeof(double));
    return Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(variable->data), count);
  }
  std::string text(const char* name) const {
    const auto variable = at(name);
    if (!variable || variable->data_type != MAT_T_UTF16) return "";
    std::string result;
    for (std::size_t i = 0; i < variable->nbytes / 2; ++i)
      append_utf8(result, static_cast<const std::uint16_t*>(variable->data)[i]);
    return result;
  }
};

TEST(ExportedMat, ReadsBackByMatio) {
  Bank bank = modebank::test::example_bank(2, 3, 4);
  bank.dt_s = 0.1;
  const TemporaryFolder folder;
  const auto file = folder.path() / "bank.mat";
  write_mat(as_exported(bank), file);
  const Opened opened(file);
  ASSERT_TRUE(opened.mat);
  EXPECT_EQ(Mat_GetVersion(opened.mat.get()), MAT_FT_MAT5);
  const auto A = opened.at("A");
  ASSERT_TRUE(A);
  ASSERT_EQ(A->rank, 3);
  EXPECT_EQ(A->dims[2], 4u);
  const Eigen::VectorXd A_numbers = opened.numbers("A"), B_numbers = opened.numbers("B"),
                        Q_numbers = opened.numbers("Q");
  for (Index k = 0; k < 4; ++k) {
    const Mode& mode = bank.modes[static_cast<std::size_t>(k)];
    const Eigen::MatrixXd full = Eigen::MatrixXd::Identity(2, 2) + mode.model.A;
    EXPECT_EQ(A_numbers.segment(4 * k, 4), full.reshaped());
    EXPECT_EQ(B_numbers.segment(6 * k, 6), mode.model.B.reshaped());
    EXPECT_EQ(Q_numbers.segment(4 * k, 4), mode.Q.reshaped());
    EXPECT_EQ(opened.numbers("c").segment(2 * k, 2), mode.model.c);
  }
  EXPECT_EQ(opened.numbers("C"), bank.C.reshaped());
  EXPECT_EQ(opened.numbers("R"), bank.R.reshaped());
  EXPECT_EQ(opened.numbers("T"), bank.transition.matrix().reshaped());
  EXPECT_EQ(opened.numbers("dt_s")(0), 0.1);
  EXPECT_THAT(opened.text("verdict"), HasSubstr("calibrated"));
  EXPECT_THAT(opened.text("ss_lines"), HasSubstr("ss(A(:,:,k), [B(:,:,k) c(:,k)], C, 0, dt_s"));
}

TEST(ExportedMat, NeedsNoInputs) {
  const TemporaryFolder folder;
  write_mat(as_exported(modebank::test::example_bank(1, 0, 1)), folder.path() / "bank.mat");
  const Opened opened(folder.path() / "bank.mat");
  EXPECT_EQ(opened.numbers("B").size(), 0);
  EXPECT_EQ(opened.numbers("T")(0), 1.0);
  EXPECT_THAT(opened.text("ss_lines"), HasSubstr("'InputName', {'one'}"));
}

TEST(ExportedMat, HoldsHostileNames) {
  ExportedBank exported = as_exported(modebank::test::example_bank(1, 1, 1));
  const TemporaryFolder folder;
  const auto file = folder.path() / "bank.mat";
  for (const std::string& name : hostile_names()) {
    exported.states[0] = exported.inputs[0] = exported.measurements[0] = {name, name};
    exported.archive = name;
    write_mat(exported, file);
    const Opened opened(file);
    const auto names = opened.at("state_names");
    ASSERT_TRUE(names) << name;
    EXPECT_EQ(names->class_type, MAT_C_CELL);
    EXPECT_NE(Mat_VarGetCell(names.get(), 0), nullptr);
    EXPECT_EQ(opened.text("ss_lines").find('\n'), std::string::npos);
  }
}

/// A bank whose channels have the given names.
ExportedBank named(const std::vector<std::string>& names) {
  ExportedBank exported = as_exported(modebank::test::example_bank(static_cast<Index>(names.size()), 1, 1));
  for (std::size_t i = 0; i < names.size(); ++i) exported.states[i] = exported.measurements[i] = {names[i], names[i]};
  exported.mode_names[0] = names[0];
  return exported;
}

/// Their letters have two or three bytes in UTF-8. The last name has a character of two UTF-16 units.
const std::vector<std::string> foreign_names{"Glätte", "µ", "速度 m/s", "a*/ \\b", "\xff", "go \U0001F600"};

TEST(ExportedMat, ScipyReadsEveryName) {
  MODEBANK_NEEDS(run_program({"/usr/bin/python3", "-c", "import scipy.io"}).status == 0,
                 "SciPy is absent: apt-get install python3-scipy");
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "bank.mat").string();
  write_mat(named(foreign_names), file);
  const auto result = run_program({"/usr/bin/python3", "-c",
                                   "import scipy.io, sys; m = scipy.io.loadmat(sys.argv[1], chars_as_strings=True)\n"
                                   "for k in ('state_names', 'measurement_units', 'mode_names'):\n"
                                   "  print(*[ascii(str(c[0][0])) for c in m[k]], sep='|')",
                                   file});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string all = R"('Gl\xe4tte'|'\xb5'|'\u901f\u5ea6 m/s'|'a*/ \\b'|'\ufffd'|'go \ufffd')";
  EXPECT_EQ(result.out, all + "\n" + all + "\n'Gl\\xe4tte'\n");
}

TEST(ExportedMat, OctaveReadsEveryName) {
  MODEBANK_NEEDS(modebank::test::has_program("octave-cli"), "Octave is absent: apt-get install octave");
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "bank.mat").string();
  write_mat(named(foreign_names), file);
  const auto result = run_program(
      {"octave-cli", "--no-gui", "--eval", "load('" + file + "'); printf('%s|', state_names{:}, mode_names{:});"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "Glätte|µ|速度 m/s|a*/ \\b|\uFFFD|go \uFFFD|Glätte|");
}

TEST(ExportedMat, OctaveLoadsAndSimulates) {
  MODEBANK_NEEDS(modebank::test::has_program("octave-cli"), "Octave is absent: apt-get install octave");
  Bank bank = modebank::test::example_bank(2, 2, 2);
  bank.dt_s = 0.1;
  const TemporaryFolder folder;
  write_mat(as_exported(bank), folder.path() / "bank.mat");
  const std::string script =
      "load('" + (folder.path() / "bank.mat").string() +
      "'); x = [0.3; -0.2]; for k = 1:10, x = A(:,:,2) * x + B(:,:,2) * [0.1; k] + c(:,2); end; printf('%.17g\\n', x);";
  const auto result = run_program({"octave-cli", "--no-gui", "--eval", script});
  ASSERT_EQ(result.status, 0) << result.err;
  Eigen::VectorXd x = Eigen::Vector2d(0.3, -0.2);
  for (int k = 1; k <= 10; ++k) x = bank.modes[1].model.next(x, Eigen::Vector2d(0.1, k));
  const std::size_t second = result.out.find('\n') + 1;
  EXPECT_NEAR(std::stod(result.out), x(0), 1e-12);
  EXPECT_NEAR(std::stod(result.out.substr(second)), x(1), 1e-12);
}

}  // namespace
}  // namespace modebank::app::test
