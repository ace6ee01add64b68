#pragma once
/// A small chart as SVG text, which every browser opens: curves and marks over a linear or logarithmic plane, or several such planes below
/// each other. No program is needed to make it.
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
  bool steps = false;       ///< level from each point to the next one's x, then straight to its y
};

/// One point with a label beside it.
struct Marker {
  double x = 0.0, y = 0.0;
  std::string label;
  std::string colour = "#b3261e";
  bool hollow = false;
};

enum class Mark { kCircle, kSquare, kTriangle, kDiamond, kRing };  ///< kRing: round another mark

/// Points that belong together, one mark each. Points that cannot be drawn, and those outside the plane, are left out.
struct Series {
  std::string label;  ///< in the legend; empty: not there
  std::vector<double> x, y;
  std::vector<std::string> labels = {};  ///< short text beside each mark, placed where it covers least; may be shorter than x
  std::string colour = "#1f4e79";
  Mark mark = Mark::kCircle;
  bool hollow = false;
  bool joined = false;  ///< a thin line from point to point
};

struct Chart {
  std::string title, subtitle;
  Axis x, y;
  std::vector<Curve> curves;
  std::vector<Marker> markers;
  std::vector<Series> series = {};
  double height = 420;  ///< of the plane [px]; it is 712 px wide
};

/// Several planes below each other under one title; the legend is that of the first.
struct Figure {
  std::string title;
  std::vector<std::string> subtitles;  ///< a line each
  std::vector<Chart> panels;           ///< their titles stand above them, their subtitles are not shown
};

/// The whole file. The same chart gives the same text, in any locale.
std::string to_svg(const Chart& chart);
std::string to_svg(const Figure& figure);

}  // namespace voxtouch::cli
