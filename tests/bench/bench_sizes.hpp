#pragma once
/// Sizes of the cup and the tools, in voxels.
namespace voxtouch::bench {

inline constexpr double kOuter = 80.0, kInner = 72.0, kFloor = 8.0,
                        kHeight = 200.0;      ///< the cup; its axis is z, its bottom at 0
inline constexpr double kBall = 50.0;         ///< radius
inline constexpr double kPlugLength = 120.0;  ///< of the flank, above a hemisphere of kInner

}  // namespace voxtouch::bench
