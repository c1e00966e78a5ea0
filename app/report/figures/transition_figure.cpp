#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/chain/mode_names.hpp"
#include "app/report/figures/palette.hpp"
#include "app/report/figures/run_figures.hpp"
#include "app/report/figures/shown_groups.hpp"
#include "app/report/page/assets.hpp"

namespace modebank::app::report {
namespace {

using Point = Eigen::Vector2d;

constexpr double least_probability = 0.005;  // rarer switches are not drawn
constexpr std::size_t most_labelled = 5;     // modes, up to which arrows have room for their numbers
constexpr double bend = 0.16;                // of an arrow's length
constexpr Index arrow_points = 25;

struct Node {
  Point at;
  double radius = 0.0;
};

struct Arrow {
  Eigen::MatrixXd line, head;  ///< points in rows
  Point label;
};

Point left_of(const Point& v) { return {-v.y(), v.x()}; }

/// On a circle, the first at the top, then clockwise; larger where a mode is used more.
std::vector<Node> nodes_of(const Bank& bank, const std::vector<Index>& modes) {
  std::vector<Node> nodes;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(modes.size());
    const double weight = bank.modes[static_cast<std::size_t>(modes[i])].weight;
    const double ring = modes.size() == 1 ? 0.0 : 0.9;
    nodes.push_back({{ring * std::sin(angle), ring * std::cos(angle)}, 0.12 + 0.13 * std::sqrt(weight)});
  }
  return nodes;
}

/// Bent to the left of its way, so that an arrow and the one back do not lie on each other.
Arrow arrow(const Node& from, const Node& to) {
  const Point way = (to.at - from.at).normalized();
  const Point control = 0.5 * (from.at + to.at) + bend * (to.at - from.at).norm() * left_of(way);
  const Point out = (control - from.at).normalized(), in = (control - to.at).normalized();
  constexpr double head_length = 0.09, head_half_width = 0.04;
  const Point start = from.at + from.radius * out, tip = to.at + (to.radius + 0.01) * in, neck = tip + head_length * in;
  Arrow result{Eigen::MatrixXd(arrow_points, 2), Eigen::MatrixXd(3, 2), 0.25 * start + 0.5 * control + 0.25 * neck};
  for (Index i = 0; i < arrow_points; ++i) {
    const double t = static_cast<double>(i) / (arrow_points - 1);
    result.line.row(i) = ((1 - t) * (1 - t) * start + 2 * t * (1 - t) * control + t * t * neck).transpose();
  }
  result.head << tip.transpose(), (neck + head_half_width * left_of(in)).transpose(),
      (neck - head_half_width * left_of(in)).transpose();
  return result;
}

/// Black or white, whichever is read better on the colour.
std::string ink_on(const std::string& colour) {
  const auto channel = [&](std::size_t at) { return std::stoi(colour.substr(at, 2), nullptr, 16); };
  return 0.299 * channel(1) + 0.587 * channel(3) + 0.114 * channel(5) > 130.0 ? "#000000" : "#ffffff";
}

std::string coordinate(double value) { return fmt::format("{:.6g}", value); }

void set_nodes(const std::vector<Node>& nodes, const std::vector<Index>& modes, Figure& figure) {
  const Palette colours = palette();
  std::vector<std::string> x, y, radius, titles, inks;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    x.push_back(coordinate(nodes[i].at.x()));
    y.push_back(coordinate(nodes[i].at.y()));
    radius.push_back(coordinate(nodes[i].radius));
    titles.push_back(fmt::format("{}", modes[i]));
    inks.push_back(ink_on(colours.modes[i]));
  }
  figure.set("nodes", std::ssize(nodes));
  figure.set("node_x", x);
  figure.set("node_y", y);
  figure.set("node_radius", radius);
  figure.set("node_title", titles);
  figure.set("node_ink", inks);
}

void set_arrows(const Bank& bank, const std::vector<Node>& nodes, const std::vector<Index>& modes, Figure& figure) {
  const Palette colours = palette();
  std::vector<Arrow> arrows;
  std::vector<std::string> x, y, widths, edge_colours, titles;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      const double probability = bank.transition.matrix()(modes[i], modes[j]);
      if (i == j || probability < least_probability) continue;
      arrows.push_back(arrow(nodes[i], nodes[j]));
      x.push_back(coordinate(arrows.back().label.x()));
      y.push_back(coordinate(arrows.back().label.y()));
      widths.push_back(coordinate(0.5 + 5.0 * std::sqrt(probability)));
      edge_colours.push_back(colours.modes[i]);
      titles.push_back(modes.size() <= most_labelled ? fmt::format("{:.2g}", probability) : "");
    }
  figure.set("edges", std::ssize(arrows));
  const std::vector<std::string> none{""};  // an array has at least one element
  figure.set("edge_x", arrows.empty() ? none : x);
  figure.set("edge_y", arrows.empty() ? none : y);
  figure.set("edge_width", arrows.empty() ? none : widths);
  figure.set("edge_colour", arrows.empty() ? none : edge_colours);
  figure.set("edge_title", arrows.empty() ? none : titles);
  for (const Arrow& drawn : arrows) figure.add_block("an arrow's line", {"x", "y"}, drawn.line);
  for (const Arrow& drawn : arrows) figure.add_block("an arrow's head", {"x", "y"}, drawn.head);
}

std::string caption_of(const Archive& archive, const ShownGroups& modes) {
  std::string names;
  for (const Index k : modes.shown)
    if (const std::string name = name_of_mode(archive.mode_names, k); !name.empty())
      names += fmt::format("{}{}: {}", names.empty() ? " Mode " : ", ", k, name);
  return fmt::format(
      "Switches between the {} modes{}: arrows are as wide as the root of their probability per sample; those below {} "
      "are "
      "left out.{}",
      modes.shown.size() + modes.others.size(),
      modes.any_others() ? fmt::format(", of which the {} most used are shown", modes.shown.size()) : "",
      least_probability, names.empty() ? "" : names + ".");
}

}  // namespace

void add_transition_figure(const Archive& archive, FigureSet& set) {
  if (!archive.bank || archive.bank->mode_count() < 2) {
    set.left_out.emplace_back("transition: there are no two modes");
    return;
  }
  const ShownGroups modes = shown_modes(archive);
  Figure figure("transition", assets::figure_transition());
  const std::vector<Node> nodes = nodes_of(*archive.bank, modes.shown);
  set_nodes(nodes, modes.shown, figure);
  set_arrows(*archive.bank, nodes, modes.shown, figure);
  figure.set_caption(caption_of(archive, modes));
  set.figures.push_back(std::move(figure));
}

}  // namespace modebank::app::report
