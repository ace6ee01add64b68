#pragma once
/// A small chart as SVG text, which every browser opens: curves over a linear or logarithmic plane. No program is needed to make it.
#include <optional>
#include <string>
#include <vector>

namespace voxtouch::cli {

struct Axis {
  std::string label;
  double low = 0.0, high = 1.0;  ///< low < high; both > 0 where logarithmic
  bool logarithmic = false;
};

/// A polyline; points that are not finite, or not above 0 on a logarithmic axis, break it. What leaves the plane is cut at its edge.
struct Curve {
  std::string label;  ///< in the legend; empty: not there
  std::vector<double> x, y;
  std::string colour = "#1f4e79";
  double width = 2.0;
  bool dashed = false;
  bool fill_below = false;  ///< shades what lies under the curve
};

/// One point with a label beside it.
struct Marker {
  double x = 0.0, y = 0.0;
  std::string label;
  std::string colour = "#b3261e";
  bool hollow = false;
};

struct Chart {
  std::string title, subtitle;
  Axis x, y;
  std::vector<Curve> curves;
  std::vector<Marker> markers;
};

/// The whole file. The same chart gives the same text, in any locale.
std::string to_svg(const Chart& chart);

}  // namespace voxtouch::cli
