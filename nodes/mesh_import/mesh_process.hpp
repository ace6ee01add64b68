#pragma once
/// Reads a mesh in a process of its own (voxtouch_import_mesh, which stands next to this program),
/// so that a file that crashes assimp, hangs it or fills memory is refused with a sentence, and
/// nothing else happens.
#include "core/mesh/import.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::mesh_import {

/// What reading one mesh may take.
struct ReadLimits {
  unsigned cpu_s = 20;              ///< CPU time; the clock may show three times as much
  std::uint64_t memory_mib = 4096;  ///< address space; not held where a sanitizer needs it
  std::filesystem::path program =
      {};  ///< voxtouch_import_mesh; empty: the one next to this program
};

/// The reader for import_mesh() and build_scene(). Throws MeshError. One process a mesh, about 10
/// ms; it ends with the calling thread, has ordinary priority whatever the caller has, and of the
/// caller's files it sees only the mesh's bytes and stderr. For any thread, not for the loop.
mesh::TriangleReader mesh_process(const ReadLimits& limits = {});

/// For those who let assimp read a scene's meshes in this process and without checks, as
/// core/reference does: it reads each in a process of its own first. Throws MeshError where that
/// crashes, hangs or fills memory. What assimp refuses passes: it will do so again.
void dry_run_reading(const scene::Scene& scene);

}  // namespace voxtouch::mesh_import
