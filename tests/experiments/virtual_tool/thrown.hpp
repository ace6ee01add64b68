#pragma once
/// What penalty forces and the virtual tool hold of a mass that is thrown at a wall, with and
/// without what the penalty ring remembers.
#include <cstdint>
#include <optional>
#include <string>

#include "rig.hpp"

namespace voxtouch::virtual_tool {

/// Who pushes the mass back; all with the stiffness that the coupling lets through, kStiffness, as
/// the largest of a frame.
struct Holder {
  std::optional<contact::ContactModelKind> model;  ///< none: the virtual tool
  bool remembers =
      true;  ///< depths that are held; else the model alone, as `rendering: memoryless`
};

/// A ball of 10 mm on a mass of 0.15 kg (stylus and hand) with 1 Ns/m, thrown at a wall at 0.02 to
/// 3 m/s up to 8 degrees askew, and pulled on by 0.1 N, a third of what one layer of voxels gives.
struct ThrowOptions {
  Holder holder;
  double thick_edges = 1.0;  ///< 0: an open sheet
  bool askew = false;
  double edge = 0.002;
  int tries = 5;
  std::uint64_t seed = 1;
};
struct ThrowFigures {
  int runs = 0, passed = 0;
  double direction_95 = 0.0;  ///< of the force where it first exceeds a twentieth of a newton,
                              ///< against the wall's normal [degrees]
};
ThrowFigures thrown(const ThrowOptions& options);

}  // namespace voxtouch::virtual_tool
