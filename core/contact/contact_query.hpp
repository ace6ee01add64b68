#pragma once
/// Finds the shell points that lie in surface or interior voxels, culling whole parts of the shell that are far from them.
#include "core/contact/contact_model.hpp"
#include "core/contact/sphere_tree.hpp"

namespace voxtouch {

/// Holds the shell and its tree; the voxmap must outlive it. Construction allocates; `find` does not.
class ContactQuery {
 public:
  ContactQuery(const Voxmap& voxmap, Pointshell shell);

  /// All hits at `tool_in_world`, in a fixed order (the shell's), so that sums give the same bits on every run.
  /// Real-time safe once `hits.reserve(shell().size())` has been called.
  void find(const Pose& tool_in_world, HitList& hits) const noexcept;

  const Pointshell& shell() const noexcept { return shell_; }

 private:
  const Voxmap& voxmap_;
  Pointshell shell_;
  SphereTree tree_;
};

}  // namespace voxtouch
