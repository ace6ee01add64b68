#pragma once
/// A proposed scene as the text of a scene file, with its reasons as comments.
#include <string>

#include "core/scene_proposal/propose_scene.hpp"

namespace voxtouch::scene_proposal {

/// Names in the text, in addition to the proposal.
struct SceneNames {
  std::string scene;                          ///< letters, digits, _ - .
  std::string part_file, tool_file;           ///< as the scene file is to name them
  double part_scale = 1.0, tool_scale = 1.0;  ///< metres for one unit of the files
};

/// A name that a scene may have, made of any text: other characters become '_'.
std::string scene_name(const std::string& text);

/// The scene file as text, each choice with its reason as a comment. Lengths in m. Allocates.
std::string scene_text(const ProposedScene& scene, const SceneNames& names);

}  // namespace voxtouch::scene_proposal
