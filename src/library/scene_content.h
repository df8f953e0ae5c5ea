#pragma once

#include <cradle/scene.h>

#include "scene/load_scene.h"

namespace cradle::v1 {

struct Scene::Content {
  LoadedScene loaded;
  std::vector<Body> bodies;
};

Vector3 arrayOf(const Vec3& vector);
Quaternion arrayOf(const Quat& rotation);

}  // namespace cradle::v1
