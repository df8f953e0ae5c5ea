#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "render/body_place.h"
#include "render/scene_builder.h"
#include "truth/passes.h"

namespace cradle {

/// A scene, and what is seen of it at its start and in a second frame that a test moves.
struct TruthScene {
  TruthScene(int pictureWidth, int pictureHeight) : width(pictureWidth), height(pictureHeight) {}

  /// A body of triangles that does not move.
  void addMesh(const DrawnMesh& mesh, const RigidTransform& place) {
    scene.models.push_back({"mesh", weld(mesh.vertices, mesh.triangles), mesh});
    scene.modelCollisions.emplace_back();
    addBody(scene, ModelShape{static_cast<int>(scene.models.size()) - 1}, place, Motion::fixed);
  }

  FrameRays& first() { return raysOf(startFrame(scene), camera, firstRays); }
  FrameRays& second(const Frame& frame, const Camera& seenBy) { return raysOf(frame, seenBy, secondRays); }

  FrameRays& raysOf(const Frame& frame, const Camera& seenBy, std::unique_ptr<FrameRays>& rays) {
    if (!source) source.emplace(scene, viewOfStart(scene, width, height));
    if (!rays)
      rays = std::make_unique<FrameRays>(*source, frame, placeBodies(scene, frame), Pinhole(seenBy, width, height));
    return *rays;
  }

  int width, height;
  Scene scene = emptyScene();
  Camera camera;
  std::optional<SurfaceSource> source;
  std::unique_ptr<FrameRays> firstRays, secondRays;
};

}  // namespace cradle
