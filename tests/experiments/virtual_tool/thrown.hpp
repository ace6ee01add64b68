#pragma once
/// A mass thrown at a wall: whether penalty forces and the virtual tool stop it, with and without
/// latched depths.
#include <cstdint>
#include <optional>
#include <string>

#include "rig.hpp"

namespace voxtouch::virtual_tool {

/// Force law that stops the mass; all display kStiffness, the largest that the coupling permits.
struct Holder {
  std::optional<contact::ContactModelKind> model;  ///< none: the virtual tool
  bool remembers = true;  ///< latched depths; false: as `rendering: memoryless`
};

/// A ball of 10 mm on a mass of 0.15 kg (stylus and hand) with 1 Ns/m, thrown at a wall at 0.02 to
/// 3 m/s, up to 8 degrees askew. It is pulled on by 0.1 N, a third of the force of one layer of
/// voxels.
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
  double direction_95 =
      0.0;  ///< of the force when it first exceeds 0.05 N, against the wall's normal [degrees]
};
ThrowFigures thrown(const ThrowOptions& options);

}  // namespace voxtouch::virtual_tool
