#pragma once
/// One plane of a chart as SVG text: grid, curves, marks and labels at their places on the page.
#include <string>
#include <string_view>
#include <vector>

#include "nodes/cli/label_layout.hpp"
#include "nodes/cli/svg_chart.hpp"

namespace voxtouch::cli {

/// Text as it may stand in XML.
std::string escaped(std::string_view text);

/// `chart` with its plane at (left, top) [px], y downwards.
class SvgPlane {
 public:
  SvgPlane(const Chart& chart, double left, double top, double width)
      : chart_(chart), left_(left), top_(top), width_(width) {}

  double bottom() const noexcept { return top_ + chart_.height; }
  /// Everything but the legend and the title; `clip` is an id that no other plane of the file has.
  std::string before_legend(std::string_view clip) const;
  std::string after_legend() const;
  std::string clip_path(std::string_view clip) const;

 private:
  double across(double x) const;
  double down(double y) const;
  bool drawable(double x, double y) const;
  bool shown(double x, double y) const;  ///< drawable and within the plane
  std::string grid() const;
  std::string curve(const Curve& line) const;
  std::string marker(const Marker& m) const;
  std::string marks() const;
  void block_steps(LabelLayout& layout) const;
  std::string labels() const;
  std::string axis_labels() const;

  const Chart& chart_;
  double left_, top_, width_;
};

/// A mark at a place on the page; also for the legend.
std::string svg_mark(const Series& series, double x, double y);
std::string svg_joint(const Series& series, const std::string& path);

}  // namespace voxtouch::cli
