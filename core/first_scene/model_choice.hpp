#pragma once
/// Which contact model a first scene gets: by what the part is, then by what was measured on it.
/// Loading only: allocates.
#include <string>
#include <vector>

#include "core/accuracy/accuracy.hpp"
#include "core/mesh/report.hpp"

namespace voxtouch::first_scene {

struct ModelChoice {
  contact::ContactModelKind model = contact::ContactModelKind::kAdapted;
  bool virtual_tool = false;  ///< with `field`, whose distances it needs
  std::string reason;         ///< a sentence
};

/// Contacts of the short measurement: the medians of so few are uncertain by half, which is enough
/// to see a model that fails.
inline constexpr std::uint32_t kMeasuredContacts = 20;

/// Whether there is an inside whose contacts can be measured.
bool has_inside(const mesh::MeshReport& part) noexcept;

/// Whether its contacts can be measured within the minute that a first scene may take.
bool is_soon_measured(const mesh::MeshReport& part) noexcept;

/// Before anything is measured: a virtual tool, which a closed part holds out, whichever way round
/// its triangles are, and an open one holds as a wall.
ModelChoice usual_model(const mesh::MeshReport& part);

/// What is measured on a part that has an inside: `adapted`, `field` and the virtual tool, at
/// voxels of `voxel_m`.
std::vector<accuracy::AccuracySetting> models_to_measure(double voxel_m);

/// From the rows of these settings. A virtual tool stays the choice, for it alone holds the hand
/// outside however deep it wants to go, unless it failed: it missed contacts, points more than 10
/// degrees off on average, or takes more than 200 us a frame. Where no truth is known for it (the
/// tool is no sphere), the contacts that `field` misses and its time speak for it, whose distances
/// it uses. After that the model that points best within 200 us. Where no row could be judged,
/// `usual`, and the reason says so.
ModelChoice measured_model(const std::vector<accuracy::AccuracyRow>& rows,
                           const ModelChoice& usual);

}  // namespace voxtouch::first_scene
