#pragma once
/// What is built once for a tool and for an object: their features with the trees over them.
#include "core/exact/box_tree.hpp"
#include "core/exact/element_tree.hpp"
#include "core/exact/feature_mesh.hpp"

namespace voxtouch::exact {

/// A static or moving object, in its own frame. Immutable: any number of tools may share one.
class ObjectBody {
 public:
  /// As find_features. Allocates, throws.
  explicit ObjectBody(const mesh::TriangleMesh& mesh);

  const FeatureMesh& features() const noexcept { return features_; }
  /// Items: faces; entries of row_edges; entries of row_vertices.
  const BoxTree& faces() const noexcept { return faces_; }
  const BoxTree& edges() const noexcept { return edges_; }
  const BoxTree& vertices() const noexcept { return vertices_; }
  std::size_t bytes() const noexcept {
    return features_.bytes() + faces_.bytes() + edges_.bytes() + vertices_.bytes();
  }

 private:
  FeatureMesh features_;
  BoxTree faces_, edges_, vertices_;
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

/// The boxes of all faces, in their order.
std::vector<Box> boxes_of_faces(const FeatureMesh& features);

}  // namespace voxtouch::exact
