#pragma once
/// Reads a mesh in a separate process (voxtouch_import_mesh, next to this program). A file that
/// crashes assimp, hangs it or fills memory is then refused without other effects.
#include "core/mesh/import.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::mesh_import {

/// Limits for reading one mesh.
struct ReadLimits {
  unsigned cpu_s = 20;              ///< CPU time; the clock may show three times as much
  std::uint64_t memory_mib = 4096;  ///< address space; not limited under a sanitizer
  std::filesystem::path program =
      {};  ///< voxtouch_import_mesh; empty: the one next to this program
};

/// The reader for import_mesh() and build_scene(). Throws MeshError. One process a mesh, about 10
/// ms; it ends with the calling thread, has ordinary priority whatever the caller has, and of the
/// caller's files it sees only the mesh's bytes and stderr. For any thread, not for the loop.
mesh::TriangleReader mesh_process(const ReadLimits& limits = {});

/// For callers that read a scene's meshes by assimp in this process and without checks, as
/// core/reference: reads each in a separate process first. Throws MeshError if that crashes, hangs
/// or fills memory. A refusal by assimp passes: it recurs.
void dry_run_reading(const scene::Scene& scene);

}  // namespace voxtouch::mesh_import
