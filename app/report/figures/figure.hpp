#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

namespace modebank::app::report {

/// A figure for a paper: a gnuplot script of app/report/figures, what it is told, and what it draws.
class Figure {
 public:
  Figure(std::string name, std::string_view script) : name_(std::move(name)), script_(script) {}

  /// Variables of the script. Texts may hold anything: they are quoted for gnuplot, line breaks become spaces.
  void set(const std::string& variable, double value);
  void set(const std::string& variable, Eigen::Index value);
  void set(const std::string& variable, const std::string& text);
  void set(const std::string& variable, const std::vector<std::string>& texts);

  /// A block of the data file: what it holds, its columns' names, and a point per row; an empty one becomes a row of
  /// NaN, so that blocks keep their numbers.
  void add_block(const std::string& title, const std::vector<std::string>& columns,
                 const Eigen::Ref<const Eigen::MatrixXd>& rows);

  /// What a reader has to know, in a sentence or two, for the LaTeX snippet.
  void set_caption(const std::string& caption) { caption_ = caption; }

  const std::string& name() const { return name_; }
  std::string script() const;  ///< complete: settings, common style, drawing
  const std::string& data() const { return data_; }
  std::string latex() const;  ///< a figure environment that includes the PDF or PNG
  /// The first lines of scripts and snippets of a figure of this name.
  std::string script_sign() const;
  std::string latex_sign() const;

 private:
  std::string name_;
  std::string_view script_;
  std::string settings_;
  std::string data_;
  std::string caption_;
};

}  // namespace modebank::app::report
