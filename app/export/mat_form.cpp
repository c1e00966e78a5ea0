#include <fmt/format.h>
#include <matio.h>

#include <array>
#include <memory>

#include "app/export/forms.hpp"
#include "app/export/names.hpp"
#include "ident/base/utf8.hpp"
#include "io/files/memory_file.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

using Eigen::MatrixXd;

/// A MAT-file for writing. The file takes ownership of the variables, and matio frees their data.
class MatFile {
 public:
  explicit MatFile(const std::filesystem::path& file)
      : file_(file),
        mat_(Mat_CreateVer(file.c_str(), "MATLAB 5.0 MAT-file, by modebank export", MAT_FT_MAT5), Mat_Close) {
    if (!mat_) fail("cannot be made");
  }

  void numbers(const char* name, const std::vector<std::size_t>& shape, const double* values) {
    std::vector<std::size_t> dimensions = shape;
    put(Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, static_cast<int>(shape.size()), dimensions.data(),
                      const_cast<double*>(values), 0));
  }
  void matrix(const char* name, const MatrixXd& M) {
    numbers(name, {static_cast<std::size_t>(M.rows()), static_cast<std::size_t>(M.cols())}, M.data());
  }
  void number(const char* name, double value) { matrix(name, MatrixXd::Constant(1, 1, value)); }
  void text(const char* name, const std::string& value) { put(text_variable(name, value)); }
  void texts(const char* name, const std::vector<std::string>& values) {
    std::array<std::size_t, 2> shape{values.size(), 1};
    std::vector<matvar_t*> cells;
    for (const std::string& value : values) cells.push_back(text_variable(nullptr, value));
    put(Mat_VarCreate(name, MAT_C_CELL, MAT_T_CELL, 2, shape.data(), cells.data(), 0));
  }

 private:
  std::filesystem::path file_;
  std::unique_ptr<mat_t, int (*)(mat_t*)> mat_;

  [[noreturn]] void fail(const std::string& what) const {
    throw DataError(fmt::format("{}: {}", file_.string(), what));
  }
  /// A dimension in the file counts characters. SciPy decodes one character from each UTF-16 unit. Octave reads that
  /// number of bytes as UTF-8. Both read the same text only if it is UTF-16 without surrogates.
  static matvar_t* text_variable(const char* name, const std::string& value) {
    std::u16string text = basic_utf16(value);
    std::array<std::size_t, 2> shape{text.empty() ? 0u : 1u, text.size()};
    return Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UTF16, 2, shape.data(), text.data(), 0);
  }
  void put(matvar_t* variable) {
    if (!variable) fail("out of memory");
    const int failed = Mat_VarWrite(mat_.get(), variable, MAT_COMPRESSION_NONE);
    Mat_VarFree(variable);
    if (failed != 0) fail("cannot be written");
  }
};

/// An array over all modes. The third dimension is the mode.
template <class Get>
void per_mode_numbers(MatFile& file, const char* name, const ExportedBank& bank, Get get) {
  std::vector<double> values;
  std::vector<std::size_t> shape{0, 0, 0};
  for (Index k = 0; k < bank.bank.mode_count(); ++k) {
    const MatrixXd M = get(k);
    shape = {static_cast<std::size_t>(M.rows()), static_cast<std::size_t>(M.cols()),
             static_cast<std::size_t>(bank.bank.mode_count())};
    values.insert(values.end(), M.data(), M.data() + M.size());
  }
  file.numbers(name, shape, values.data());
}

void add_channels(MatFile& file, const std::string& kind, const std::vector<Channel>& channels) {
  std::vector<std::string> names, units;
  for (const Channel& channel : channels) {
    names.push_back(channel.name);
    units.push_back(channel.unit);
  }
  file.texts((kind + "_names").c_str(), names);
  file.texts((kind + "_units").c_str(), units);
}

/// The family of each mode. Families are numbered from one, as in MATLAB.
void add_families(MatFile& file, const ExportedBank& exported) {
  MatrixXd family = MatrixXd::Zero(1, exported.bank.mode_count());
  std::vector<std::string> titles;
  for (const ModeFamily& of : exported.families) {
    titles.push_back(of.title());
    for (const Index k : of.modes) family(0, k) = static_cast<double>(titles.size());
  }
  file.texts("family_names", titles);
  file.matrix("mode_family", family);
}

/// MATLAB code that makes a state space model of mode k. It works with Control System Toolbox and with Octave's control
/// package. c becomes the gain of a constant input 1.
std::string ss_lines(const ExportedBank& exported) {
  const auto list = [](const std::vector<Channel>& channels) {
    std::vector<std::string> names;
    for (const Channel& channel : channels) names.push_back(channel.name);
    std::string text;
    for (const std::string& name : identifiers(names, Language::c)) text += (text.empty() ? "'" : ", '") + name + "'";
    return "{" + text + "}";
  };
  std::string inputs = list(exported.inputs);
  inputs.insert(inputs.size() - 1, exported.inputs.empty() ? "'one'" : ", 'one'");
  return fmt::format(
      "k = 1; sys = ss(A(:,:,k), [B(:,:,k) c(:,k)], C, 0, dt_s, 'StateName', {}, 'InputName', {}, 'OutputName', {}); "
      "y = lsim(sys, [u ones(size(u, 1), 1)], [], x0);",
      list(exported.states), inputs, list(exported.measurements));
}

}  // namespace

namespace {

void fill_mat(const ExportedBank& exported, const std::filesystem::path& path) {
  const Bank& bank = exported.bank;
  const auto mode = [&](Index k) -> const Mode& { return bank.modes[static_cast<std::size_t>(k)]; };
  const auto errors = [&](Index k) -> const ModeErrors& { return exported.errors[static_cast<std::size_t>(k)]; };
  const auto of_modes = [&](const auto& get) {
    MatrixXd columns(bank.structure.dimension(), bank.mode_count());
    for (Index k = 0; k < columns.cols(); ++k) columns.col(k) = get(k);
    return columns;
  };
  MatFile file(path);
  file.text("verdict", exported.verdict_text());
  file.text("equation", exported_equation);
  file.texts("remarks", exported.remarks());
  file.text("T_rows", transition_meaning);
  file.text("archive", exported.archive);
  file.text("sha256", exported.sha256);
  file.text("schema_version", export_schema_version);
  file.number("dt_s", bank.dt_s);
  file.number("input_lag_s", exported.input_lag_s);
  per_mode_numbers(file, "A", exported, [&](Index k) { return exported.A(k); });
  per_mode_numbers(file, "B", exported, [&](Index k) { return mode(k).model.B; });
  file.matrix("c", of_modes([&](Index k) { return mode(k).model.c; }));
  per_mode_numbers(file, "Q", exported, [&](Index k) { return mode(k).Q; });
  per_mode_numbers(file, "A_standard_error", exported, [&](Index k) { return errors(k).A; });
  per_mode_numbers(file, "B_standard_error", exported, [&](Index k) { return errors(k).B; });
  file.matrix("c_standard_error", of_modes([&](Index k) { return errors(k).c; }));
  if (bank.modes.front().Q_standard_error.size() > 0)
    per_mode_numbers(file, "Q_standard_error", exported, [&](Index k) { return mode(k).Q_standard_error; });
  file.matrix("C", bank.C);
  file.matrix("R", bank.R);
  if (bank.R_standard_error.size() > 0) file.matrix("R_standard_error", bank.R_standard_error);
  file.matrix("T", bank.transition.matrix());
  if (bank.transition_standard_error.size() > 0) file.matrix("T_standard_error", bank.transition_standard_error);
  file.matrix("initial_probability", bank.initial_probability);
  if (!bank.transition_logit.empty()) {
    file.matrix("logit_weights", bank.transition_logit.weights);
    file.matrix("logit_reference", bank.transition_logit.reference);
  }
  add_channels(file, "state", exported.states);
  add_channels(file, "input", exported.inputs);
  add_channels(file, "measurement", exported.measurements);
  file.texts("mode_names", exported.mode_names);
  add_families(file, exported);
  file.text("ss_lines", ss_lines(exported));
}

}  // namespace

void write_mat(const ExportedBank& exported, const std::filesystem::path& path) {
  const MemoryFile memory;
  fill_mat(exported, memory.path());
  replace_file(final_target(path), {memory.content()});
}

}  // namespace modebank::app
