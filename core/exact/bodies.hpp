#pragma once
/// What is built once for a tool and for an object: their features with the trees over them.
#include <span>
#include <vector>

#include "core/exact/box_tree.hpp"
#include "core/exact/element_tree.hpp"
#include "core/exact/feature_mesh.hpp"

namespace voxtouch::exact {

/// The three ways in which two polyhedra can touch; the tool's feature first.
enum class PairKind : std::uint8_t { kVertexFace, kFaceVertex, kEdgeEdge };

/// A static or moving object, in its own frame. Immutable: any number of tools may share one.
///
/// Objects that touch or overlap are one body, or the edges at their seams would hold a tool. Each
/// of its triangles then has an owner, which receives what its triangles push with.
class ObjectBody {
 public:
  /// `owners`: of each triangle, numbered from 0 without gaps; empty: all have one. Errors as
  /// find_features, and std::invalid_argument for another number of owners than of triangles.
  /// Allocates.
  explicit ObjectBody(const mesh::TriangleMesh& mesh, std::span<const std::uint32_t> owners = {});

  const FeatureMesh& features() const noexcept { return features_; }
  /// Items: faces; entries of row_edges; entries of row_vertices.
  const BoxTree& faces() const noexcept { return faces_; }
  const BoxTree& edges() const noexcept { return edges_; }
  const BoxTree& vertices() const noexcept { return vertices_; }
  /// Of each item of `edges`.
  std::span<const NormalCone> edge_cones() const noexcept { return edge_cones_; }
  std::size_t owners() const noexcept { return owners_; }
  /// Of item `item` of the tree that pairs of this kind look at. Real-time safe.
  std::uint32_t owner_of(PairKind kind, std::uint32_t item) const noexcept;
  std::size_t bytes() const noexcept {
    return features_.bytes() + faces_.bytes() + edges_.bytes() + vertices_.bytes() +
           edge_cones_.size() * sizeof(NormalCone) + owner_of_face_.size() * sizeof(std::uint32_t);
  }

 private:
  FeatureMesh features_;
  std::vector<NormalCone> edge_cones_;
  BoxTree faces_, edges_, vertices_;
  std::vector<std::uint32_t> owner_of_face_;  ///< empty: all have one
  std::size_t owners_ = 1;
};

/// The tool, in T. Immutable.
class ToolBody {
 public:
  /// As find_features. Allocates, throws.
  explicit ToolBody(const mesh::TriangleMesh& mesh);

  const FeatureMesh& features() const noexcept { return features_; }
  /// Elements: entries of row_vertices; faces; entries of row_edges.
  const ElementTree& vertices() const noexcept { return vertices_; }
  const ElementTree& faces() const noexcept { return faces_; }
  const ElementTree& edges() const noexcept { return edges_; }
  const BoxTree& face_boxes() const noexcept { return face_boxes_; }
  std::size_t bytes() const noexcept {
    return features_.bytes() + vertices_.bytes() + faces_.bytes() + edges_.bytes() +
           face_boxes_.bytes();
  }

 private:
  FeatureMesh features_;
  ElementTree vertices_, faces_, edges_;
  BoxTree face_boxes_;
};

/// find_features, less what other parts of the mesh cover. Allocates, throws.
FeatureMesh free_features(const mesh::TriangleMesh& mesh);

/// The normals of each entry of row_edges.
std::vector<NormalCone> edge_cones(const FeatureMesh& features);

/// The boxes of all faces, in their order.
std::vector<Box> boxes_of_faces(const FeatureMesh& features);

}  // namespace voxtouch::exact
