#include "nodes/cli/svg_chart.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

namespace voxtouch::cli {
namespace {

constexpr double kWidth = 820, kLeft = 84, kRight = 24, kTop = 66, kPlotHeight = 420, kBottom = 58, kLegendRow = 20;
constexpr double kPlotWidth = kWidth - kLeft - kRight;

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

/// Share of the axis at `value`: 0 at its low end, 1 at its high one.
double share(const Axis& axis, double value) {
  if (axis.logarithmic) return std::log(value / axis.low) / std::log(axis.high / axis.low);
  return (value - axis.low) / (axis.high - axis.low);
}

double across(const Chart& c, double x) { return kLeft + kPlotWidth * share(c.x, x); }
double down(const Chart& c, double y) { return kTop + kPlotHeight * (1.0 - share(c.y, y)); }

std::vector<double> ticks(const Axis& axis) {
  std::vector<double> at;
  if (axis.logarithmic) {
    const bool wide = axis.high / axis.low > 2000.0;
    for (double decade = std::pow(10.0, std::floor(std::log10(axis.low))); decade <= axis.high; decade *= 10.0)
      for (const double step : {1.0, 2.0, 5.0})
        if ((step == 1.0 || !wide) && decade * step >= axis.low * 0.999 && decade * step <= axis.high * 1.001)
          at.push_back(decade * step);
    return at;
  }
  const double raw = (axis.high - axis.low) / 6.0, power = std::pow(10.0, std::floor(std::log10(raw)));
  const double step = power * (raw / power > 5 ? 10 : raw / power > 2 ? 5 : raw / power > 1 ? 2 : 1);
  for (double value = std::ceil(axis.low / step) * step; value <= axis.high + 1e-9 * step; value += step)
    at.push_back(std::abs(value) < 1e-9 * step ? 0.0 : value);
  return at;
}

std::string grid(const Chart& c) {
  std::string out;
  for (const double x : ticks(c.x))
    out += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" class=\"grid\"/>"
        "<text x=\"{0:.1f}\" y=\"{3}\" class=\"tick\" text-anchor=\"middle\">{4:g}</text>\n",
        across(c, x), kTop, kTop + kPlotHeight, kTop + kPlotHeight + 20, x);
  for (const double y : ticks(c.y))
    out += fmt::format(
        "<line x1=\"{1}\" x2=\"{2}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\" class=\"grid\"/>"
        "<text x=\"{3}\" y=\"{4:.1f}\" class=\"tick\" text-anchor=\"end\">{5:g}</text>\n",
        down(c, y), kLeft, kLeft + kPlotWidth, kLeft - 8, down(c, y) + 4, y);
  return out;
}

bool drawable(const Axis& axis, double value) { return std::isfinite(value) && (!axis.logarithmic || value > 0.0); }

std::string curve(const Chart& c, const Curve& line) {
  std::string out;
  const std::size_t count = std::min(line.x.size(), line.y.size());
  // The clip path cuts at the plane's edge; far values are only kept from growing beyond what SVG readers take.
  const auto row = [&](double y) { return std::clamp(down(c, y), -1e4, 1e4); };
  for (std::size_t i = 0; i < count;) {
    while (i < count && !(drawable(c.x, line.x[i]) && drawable(c.y, line.y[i]))) ++i;
    std::string path;
    const std::size_t first = i;
    for (; i < count && drawable(c.x, line.x[i]) && drawable(c.y, line.y[i]); ++i)
      path += fmt::format("{}{:.1f},{:.1f} ", path.empty() ? "M" : "L", across(c, line.x[i]), row(line.y[i]));
    if (path.empty()) continue;
    if (line.fill_below)
      out += fmt::format("<path d=\"{}L{:.1f},{} L{:.1f},{} Z\" fill=\"{}\" opacity=\"0.13\" stroke=\"none\"/>\n", path,
                         across(c, line.x[i - 1]), kTop + kPlotHeight, across(c, line.x[first]), kTop + kPlotHeight,
                         line.colour);
    out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{}/>\n", path, line.colour,
                       line.width, line.dashed ? " stroke-dasharray=\"7 5\"" : "");
  }
  return out;
}

std::string marker(const Chart& c, const Marker& m) {
  if (!drawable(c.x, m.x) || !drawable(c.y, m.y)) return "";
  const double x = across(c, m.x), y = down(c, m.y);
  const bool left = x > kLeft + 0.66 * kPlotWidth, below = y < kTop + 24;  // the label must stay within the plane
  return fmt::format(
      "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"6\" fill=\"{}\" stroke=\"{}\" stroke-width=\"2.5\"/>"
      "<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"mark\" text-anchor=\"{}\" style=\"fill:{}\">{}</text>\n",
      x, y, m.hollow ? "#fff" : m.colour, m.colour, x + (left ? -11 : 11), y + (below ? 20 : -9),
      left ? "end" : "start", m.colour, escaped(m.label));
}

std::vector<const Curve*> named(const Chart& c) {
  std::vector<const Curve*> out;
  for (const Curve& line : c.curves)
    if (!line.label.empty()) out.push_back(&line);
  return out;
}

/// Below the plane, two a row: inside it would lie on the curves.
std::string legend(const Chart& c) {
  std::string out;
  double column = 0, y = kTop + kPlotHeight + kBottom;
  for (const Curve* line : named(c)) {
    const double x = kLeft + column * kPlotWidth / 2;
    out += fmt::format(
        "<line x1=\"{:.0f}\" x2=\"{:.0f}\" y1=\"{:.0f}\" y2=\"{:.0f}\" stroke=\"{}\" stroke-width=\"{}\"{}/>"
        "<text x=\"{:.0f}\" y=\"{:.0f}\" class=\"tick\">{}</text>\n",
        x, x + 30, y, y, line->colour, line->width, line->dashed ? " stroke-dasharray=\"7 5\"" : "", x + 38, y + 4,
        escaped(line->label));
    column = 1 - column;
    if (column == 0) y += kLegendRow;
  }
  return out;
}

double height(const Chart& c) {
  const auto rows = static_cast<double>((named(c).size() + 1) / 2);
  return kTop + kPlotHeight + kBottom + rows * kLegendRow;
}

}  // namespace

std::string to_svg(const Chart& c) {
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\">\n"
      "<style>text{{font-family:sans-serif;fill:#222}} .tick{{font-size:12px}} .label{{font-size:13px}} "
      ".mark{{font-size:12.5px;font-weight:bold;paint-order:stroke;stroke:#fff;stroke-width:3px}} .title{{font-size:17px;font-weight:bold}} "
      ".grid{{stroke:#e3e3e3}}</style>\n"
      "<clipPath id=\"plane\"><rect x=\"{2}\" y=\"{3}\" width=\"{4}\" height=\"{5}\"/></clipPath>\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
      kWidth, height(c), kLeft, kTop, kPlotWidth, kPlotHeight);
  out += fmt::format(
      "<text x=\"{}\" y=\"28\" class=\"title\">{}</text><text x=\"{}\" y=\"50\" class=\"label\">{}</text>\n", kLeft,
      escaped(c.title), kLeft, escaped(c.subtitle));
  out += grid(c);
  out += "<g clip-path=\"url(#plane)\">\n";
  for (const Curve& line : c.curves) out += curve(c, line);
  out += "</g>\n";
  out += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#555\"/>\n", kLeft,
                     kTop, kPlotWidth, kPlotHeight);
  out += legend(c);
  for (const Marker& m : c.markers) out += marker(c, m);
  out += fmt::format(
      "<text x=\"{}\" y=\"{}\" class=\"label\" text-anchor=\"middle\">{}</text>\n"
      "<text transform=\"translate(22 {}) rotate(-90)\" class=\"label\" text-anchor=\"middle\">{}</text>\n</svg>\n",
      kLeft + kPlotWidth / 2, kTop + kPlotHeight + 40, escaped(c.x.label), kTop + kPlotHeight / 2, escaped(c.y.label));
  return out;
}

}  // namespace voxtouch::cli
