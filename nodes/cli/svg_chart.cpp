#include "nodes/cli/svg_chart.hpp"

#include <fmt/format.h>

#include "nodes/cli/svg_plane.hpp"

namespace voxtouch::cli {
namespace {

constexpr double kWidth = 820, kLeft = 84, kRight = 24, kTop = 66, kBottom = 58, kLegendRow = 20;
constexpr double kPlotWidth = kWidth - kLeft - kRight;
constexpr double kSubtitleRow = 18, kPanelTitle = 26;  ///< a further subtitle; the line above a further panel

/// One row of the legend: a stretch of line, a mark, or both, from `x` on.
struct Entry {
  std::string label;
  const Curve* curve = nullptr;
  const Series* series = nullptr;

  std::string symbol(double x, double y) const {
    if (curve)
      return fmt::format(
          "<line x1=\"{:.0f}\" x2=\"{:.0f}\" y1=\"{:.0f}\" y2=\"{:.0f}\" stroke=\"{}\" "
          "stroke-width=\"{}\"{}/>",
          x, x + 30, y, y, curve->colour, curve->width, curve->dashed ? " stroke-dasharray=\"7 5\"" : "");
    return (series->joined ? svg_joint(*series, fmt::format("M{:.0f},{:.0f} h30", x, y)) : std::string()) +
           svg_mark(*series, x + 15, y);
  }
};

std::vector<Entry> entries(const Chart& c) {
  std::vector<Entry> out;
  for (const Series& s : c.series)
    if (!s.label.empty()) out.push_back({s.label, nullptr, &s});
  for (const Curve& line : c.curves)
    if (!line.label.empty()) out.push_back({line.label, &line, nullptr});
  return out;
}

/// Below the plane, two a row: inside it would lie on the curves.
std::string legend(const Chart& c, double y) {
  std::string out;
  double column = 0;
  for (const Entry& entry : entries(c)) {
    const double x = kLeft + column * kPlotWidth / 2;
    out += entry.symbol(x, y) + fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" class=\"tick\">{}</text>\n", x + 38, y + 4,
                                            escaped(entry.label));
    column = 1 - column;
    if (column == 0) y += kLegendRow;
  }
  return out;
}

std::string clip_id(std::size_t panel) { return panel == 0 ? "plane" : fmt::format("plane{}", panel + 1); }

std::vector<SvgPlane> planes_of(const Figure& figure) {
  std::vector<SvgPlane> planes;
  double top = kTop;
  if (figure.subtitles.size() > 1) top += kSubtitleRow * static_cast<double>(figure.subtitles.size() - 1);
  for (const Chart& panel : figure.panels) {
    planes.emplace_back(panel, kLeft, top, kPlotWidth);
    top = planes.back().bottom() + kBottom + kPanelTitle;
  }
  return planes;
}

std::string titles(const Figure& figure) {
  std::string out = fmt::format("<text x=\"{}\" y=\"28\" class=\"title\">{}</text>", kLeft, escaped(figure.title));
  for (std::size_t i = 0; i < figure.subtitles.size(); ++i)
    out += fmt::format("<text x=\"{}\" y=\"{}\" class=\"label\">{}</text>\n", kLeft,
                       50 + kSubtitleRow * static_cast<double>(i), escaped(figure.subtitles[i]));
  return out;
}

}  // namespace

std::string to_svg(const Figure& figure) {
  const std::vector<SvgPlane> planes = planes_of(figure);
  const double legend_top = planes.empty() ? kTop : planes.back().bottom() + kBottom;
  const std::size_t named = planes.empty() ? 0 : entries(figure.panels.front()).size();
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\">\n"
      "<style>text{{font-family:sans-serif;fill:#222}} .tick{{font-size:12px}} .label{{font-size:13px}} "
      ".mark{{font-size:12.5px;font-weight:bold;paint-order:stroke;stroke:#fff;stroke-width:3px}} "
      ".size{{font-size:11px;paint-order:stroke;stroke:#fff;stroke-width:2.5px}} "
      ".title{{font-size:17px;font-weight:bold}} .panel{{font-size:14px;font-weight:bold}} "
      ".grid{{stroke:#e3e3e3}}</style>\n",
      kWidth, legend_top + static_cast<double>((named + 1) / 2) * kLegendRow);
  for (std::size_t i = 0; i < planes.size(); ++i) out += planes[i].clip_path(clip_id(i));
  out += fmt::format("<rect width=\"{}\" height=\"100%\" fill=\"#fff\"/>\n", kWidth) + titles(figure);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (i > 0)
      out += fmt::format("<text x=\"{}\" y=\"{}\" class=\"panel\">{}</text>\n", kLeft,
                         planes[i - 1].bottom() + kBottom + kPanelTitle - 10, escaped(figure.panels[i].title));
    out += planes[i].before_legend(clip_id(i));
    if (i == 0) out += legend(figure.panels.front(), legend_top);
    out += planes[i].after_legend();
  }
  return out + "</svg>\n";
}

std::string to_svg(const Chart& chart) { return to_svg(Figure{chart.title, {chart.subtitle}, {chart}}); }

}  // namespace voxtouch::cli
