#include <cradle/scene.h>

#include <utility>

#include "library/scene_content.h"
#include "library/translated.h"

namespace cradle::v1 {
namespace {

Motion motionOf(cradle::Motion motion) {
  if (motion == cradle::Motion::dynamic) return Motion::dynamic;
  return motion == cradle::Motion::driven ? Motion::driven : Motion::fixed;
}

Matrix3 rowsOf(const Mat3& matrix) {
  Matrix3 rows{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = matrix(i, j);
  return rows;
}

Body bodyOf(const cradle::Body& body) {
  const RigidTransform& place = body.worldFromBody;
  return {body.name,
          motionOf(body.motion),
          body.massProperties.mass,
          arrayOf(body.massProperties.centerOfMass),
          rowsOf(body.massProperties.inertiaTensor),
          arrayOf(place * body.massProperties.centerOfMass),
          arrayOf(place.rotation),
          arrayOf(body.linearVelocity),
          arrayOf(body.angularVelocity)};
}

std::shared_ptr<const Scene::Content> contentOf(LoadedScene loaded) {
  auto content = std::make_shared<Scene::Content>();
  for (const cradle::Body& body : loaded.scene.bodies) content->bodies.push_back(bodyOf(body));
  content->loaded = std::move(loaded);
  return content;
}

}  // namespace

Vector3 arrayOf(const Vec3& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

Quaternion arrayOf(const Quat& rotation) {
  return {rotation.w(), rotation.x(), rotation.y(), rotation.z()};
}

Scene Scene::load(const std::string& path) {
  return translated([&] { return Scene(contentOf(loadScene(path))); });
}

Scene Scene::parse(const std::string& text, const std::string& path) {
  return translated(
      [&] { return Scene(contentOf(parseScene(text, path, modelFilesBeside(path), textureFilesBeside(path)))); });
}

const std::string& Scene::name() const {
  return content_->loaded.scene.name;
}

const std::string& Scene::text() const {
  return content_->loaded.scene.text;
}

double Scene::duration() const {
  return content_->loaded.scene.duration;
}

long Scene::frameCount() const {
  return lastFrame(content_->loaded.scene) + 1;
}

int Scene::pictureWidth() const {
  return content_->loaded.scene.output.width;
}

int Scene::pictureHeight() const {
  return content_->loaded.scene.output.height;
}

const std::vector<Body>& Scene::bodies() const {
  return content_->bodies;
}

std::vector<int> Scene::movingBodies() const {
  std::vector<int> moving;
  for (std::size_t i = 0; i < content_->bodies.size(); ++i)
    if (content_->bodies[i].motion != Motion::fixed) moving.push_back(static_cast<int>(i));
  return moving;
}

std::vector<std::string> Scene::joints() const {
  std::vector<std::string> names;
  for (const Hinge& hinge : content_->loaded.scene.hinges) names.push_back(hinge.name);
  for (const Slider& slider : content_->loaded.scene.sliders) names.push_back(slider.name);
  return names;
}

const std::vector<std::string>& Scene::warnings() const {
  return content_->loaded.warnings;
}

}  // namespace cradle::v1
