#include "nodes/cli/svg_plane.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace voxtouch::cli {
namespace {

constexpr double kMarkRadius = 5, kRingRadius = 10, kLabelHeight = 11, kCharacterWidth = 6.3;

/// Share of the axis at `value`: 0 at its low end, 1 at its high one.
double share(const Axis& axis, double value) {
  if (axis.logarithmic) return std::log(value / axis.low) / std::log(axis.high / axis.low);
  return (value - axis.low) / (axis.high - axis.low);
}

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

bool drawable_on(const Axis& axis, double value) { return std::isfinite(value) && (!axis.logarithmic || value > 0.0); }

bool within(const Axis& axis, double value) {
  const double at = share(axis, value);
  return at >= -1e-9 && at <= 1.0 + 1e-9;
}

}  // namespace

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

std::string svg_mark(const Series& s, double x, double y) {
  const std::string fill = s.hollow || s.mark == Mark::kRing ? "#fff" : s.colour;
  const auto shape = [&](const std::string& path) {
    return fmt::format("<path d=\"{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"2\"/>\n", path, fill, s.colour);
  };
  const double r = kMarkRadius;
  switch (s.mark) {
    case Mark::kCircle:
      return fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"2\"/>\n", x, y,
          r - 0.5, fill, s.colour);
    case Mark::kSquare: {
      const double h = 0.85 * r;
      return shape(fmt::format("M{:.1f},{:.1f} h{} v{} h-{} Z", x - h, y - h, 2 * h, 2 * h, 2 * h));
    }
    case Mark::kTriangle:
      return shape(fmt::format("M{:.1f},{:.1f} L{:.1f},{:.1f} L{:.1f},{:.1f} Z", x, y - 1.1 * r, x + r, y + 0.8 * r,
                               x - r, y + 0.8 * r));
    case Mark::kDiamond: {
      const double h = 1.2 * r;
      return shape(fmt::format("M{:.1f},{:.1f} L{:.1f},{:.1f} L{:.1f},{:.1f} L{:.1f},{:.1f} Z", x, y - h, x + h, y, x,
                               y + h, x - h, y));
    }
    case Mark::kRing: break;
  }
  return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>\n",
                     x, y, kRingRadius, s.colour);
}

std::string svg_joint(const Series& s, const std::string& path) {
  return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1\" opacity=\"0.55\"/>\n", path,
                     s.colour);
}

double SvgPlane::across(double x) const { return left_ + width_ * share(chart_.x, x); }
double SvgPlane::down(double y) const { return top_ + chart_.height * (1.0 - share(chart_.y, y)); }
bool SvgPlane::drawable(double x, double y) const { return drawable_on(chart_.x, x) && drawable_on(chart_.y, y); }
bool SvgPlane::shown(double x, double y) const { return drawable(x, y) && within(chart_.x, x) && within(chart_.y, y); }

std::string SvgPlane::clip_path(std::string_view clip) const {
  return fmt::format("<clipPath id=\"{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n", clip,
                     left_, top_, width_, chart_.height);
}

std::string SvgPlane::grid() const {
  std::string out;
  for (const double x : ticks(chart_.x))
    out += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" class=\"grid\"/>"
        "<text x=\"{0:.1f}\" y=\"{3}\" class=\"tick\" text-anchor=\"middle\">{4:g}</text>\n",
        across(x), top_, bottom(), bottom() + 20, x);
  for (const double y : ticks(chart_.y))
    out += fmt::format(
        "<line x1=\"{1}\" x2=\"{2}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\" class=\"grid\"/>"
        "<text x=\"{3}\" y=\"{4:.1f}\" class=\"tick\" text-anchor=\"end\">{5:g}</text>\n",
        down(y), left_, left_ + width_, left_ - 8, down(y) + 4, y);
  return out;
}

std::string SvgPlane::curve(const Curve& line) const {
  std::string out;
  const std::size_t count = std::min(line.x.size(), line.y.size());
  // The clip path cuts at the plane's edge; far values are only kept from growing beyond what SVG readers take.
  const auto row = [&](double y) { return std::clamp(down(y), -1e4, 1e4); };
  for (std::size_t i = 0; i < count;) {
    while (i < count && !drawable(line.x[i], line.y[i])) ++i;
    std::string path;
    const std::size_t first = i;
    for (; i < count && drawable(line.x[i], line.y[i]); ++i) {
      if (line.steps && i > first) path += fmt::format("L{:.1f},{:.1f} ", across(line.x[i]), row(line.y[i - 1]));
      path += fmt::format("{}{:.1f},{:.1f} ", path.empty() ? "M" : "L", across(line.x[i]), row(line.y[i]));
    }
    if (path.empty()) continue;
    if (line.fill_below)
      out += fmt::format("<path d=\"{}L{:.1f},{} L{:.1f},{} Z\" fill=\"{}\" opacity=\"0.13\" stroke=\"none\"/>\n", path,
                         across(line.x[i - 1]), bottom(), across(line.x[first]), bottom(), line.colour);
    out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{}/>\n", path, line.colour,
                       line.width, line.dashed ? " stroke-dasharray=\"7 5\"" : "");
  }
  return out;
}

std::string SvgPlane::marker(const Marker& m) const {
  if (!drawable(m.x, m.y)) return "";
  const double x = across(m.x), y = down(m.y);
  const bool left = x > left_ + 0.66 * width_, below = y < top_ + 24;  // the label must stay within the plane
  return fmt::format(
      "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"6\" fill=\"{}\" stroke=\"{}\" stroke-width=\"2.5\"/>"
      "<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"mark\" text-anchor=\"{}\" style=\"fill:{}\">{}</text>\n",
      x, y, m.hollow ? "#fff" : m.colour, m.colour, x + (left ? -11 : 11), y + (below ? 20 : -9),
      left ? "end" : "start", m.colour, escaped(m.label));
}

std::string SvgPlane::marks() const {
  std::string joints, out;
  for (const Series& s : chart_.series) {
    std::string path;
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
      if (!shown(s.x[i], s.y[i])) continue;
      path += fmt::format("{}{:.1f},{:.1f} ", path.empty() ? "M" : "L", across(s.x[i]), down(s.y[i]));
      out += svg_mark(s, across(s.x[i]), down(s.y[i]));
    }
    if (s.joined && path.contains('L')) joints += svg_joint(s, path);
  }
  return joints + out;  // lines lie under every mark
}

/// Stairs are where labels would lie on a line; slanted lines cross them at one point only.
void SvgPlane::block_steps(LabelLayout& layout) const {
  for (const Curve& line : chart_.curves)
    for (std::size_t i = 1; line.steps && i < std::min(line.x.size(), line.y.size()); ++i) {
      if (!drawable(line.x[i - 1], line.y[i - 1]) || !drawable(line.x[i], line.y[i])) continue;
      const double x0 = across(line.x[i - 1]), x1 = across(line.x[i]), y0 = down(line.y[i - 1]), y1 = down(line.y[i]);
      layout.block({std::min(x0, x1), y0 - 1, std::max(x0, x1), y0 + 1});
      layout.block({x1 - 1, std::min(y0, y1), x1 + 1, std::max(y0, y1)});
    }
}

std::string SvgPlane::labels() const {
  LabelLayout layout({left_, top_, left_ + width_, bottom()});
  block_steps(layout);
  for (const Series& s : chart_.series) {
    const double r = s.mark == Mark::kRing ? kRingRadius + 1 : kMarkRadius + 1;
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i)
      if (shown(s.x[i], s.y[i]))
        layout.block({across(s.x[i]) - r, down(s.y[i]) - r, across(s.x[i]) + r, down(s.y[i]) + r});
  }
  std::string out;
  for (const Series& s : chart_.series)
    for (std::size_t i = 0; i < std::min({s.x.size(), s.y.size(), s.labels.size()}); ++i) {
      if (!shown(s.x[i], s.y[i]) || s.labels[i].empty()) continue;
      const Box box =
          layout.place(across(s.x[i]), down(s.y[i]), kCharacterWidth * static_cast<double>(s.labels[i].size()),
                       kLabelHeight, kMarkRadius + 4);
      out += fmt::format(
          "<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"size\" text-anchor=\"middle\" style=\"fill:{}\">{}</text>\n",
          (box.left + box.right) / 2, box.bottom - 1.5, s.colour, escaped(s.labels[i]));
    }
  return out;
}

std::string SvgPlane::axis_labels() const {
  return fmt::format(
      "<text x=\"{}\" y=\"{}\" class=\"label\" text-anchor=\"middle\">{}</text>\n"
      "<text transform=\"translate(22 {}) rotate(-90)\" class=\"label\" text-anchor=\"middle\">{}</text>\n",
      left_ + width_ / 2, bottom() + 40, escaped(chart_.x.label), top_ + chart_.height / 2, escaped(chart_.y.label));
}

std::string SvgPlane::before_legend(std::string_view clip) const {
  std::string out = grid();
  out += fmt::format("<g clip-path=\"url(#{})\">\n", clip);
  for (const Curve& line : chart_.curves) out += curve(line);
  out += "</g>\n";
  out += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#555\"/>\n", left_,
                     top_, width_, chart_.height);
  return out;
}

std::string SvgPlane::after_legend() const {
  std::string out = marks() + labels();
  for (const Marker& m : chart_.markers) out += marker(m);
  return out + axis_labels();
}

}  // namespace voxtouch::cli
