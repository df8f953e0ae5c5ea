#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "commands/glb_file.h"
#include "scene/scene.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Puts what bodies look like into a GlbFile: each shape once, however many bodies and materials it has.
class GlbMeshes {
 public:
  /// All must outlive this object.
  GlbMeshes(const TrajectoryHeader& header, const Scene& scene, GlbFile& file)
      : header_(header), scene_(scene), file_(file) {}

  /// The mesh of a body, other than a plane, in the body's frame.
  int ofBody(std::size_t body);

  /// A mesh that is no body's.
  int add(const std::string& name, const DrawnMesh& drawn, const std::string& material, const Surface& surface);

 private:
  /// The arrays of a drawn mesh, one of indices for each range of triangles.
  struct Geometry {
    struct Range {
      std::string materialName;
      std::optional<Vec3f> fileColor;  // sRGB
      SharedTexture fileTexture;
      int indices = 0;
    };
    std::string name;
    int positions = 0, normals = 0;
    int coordinates = -1;  // on a texture; -1: none
    std::vector<Range> ranges = {};
    bool isClosed = true;  // else its inside may be seen
  };
  Geometry addGeometry(const std::string& name, const DrawnMesh& drawn);
  Geometry addShape(const Shape& shape);

  const TrajectoryHeader& header_;
  const Scene& scene_;
  GlbFile& file_;
  std::map<std::string, Geometry> geometries_;  // by shape
};

}  // namespace cradle
