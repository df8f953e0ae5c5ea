#include "truth/truth_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "render/body_place.h"

namespace cradle {
namespace {

using Json = nlohmann::ordered_json;

template <class Vector>
Json numbersOf(const Vector& vector) {
  Json numbers = Json::array();
  for (const double number : vector) numbers.push_back(number);
  return numbers;
}

template <class Matrix>
Json rowsOf(const Matrix& matrix) {
  Json rows = Json::array();
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    rows.push_back(numbersOf(Eigen::VectorXd(matrix.row(row).transpose())));
  return rows;
}

Json quaternionOf(const Quat& turn) {
  return {turn.w(), turn.x(), turn.y(), turn.z()};
}

Eigen::Matrix4d matrixOf(const Mat3& rotation, const Vec3& translation) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = rotation;
  matrix.topRightCorner<3, 1>() = translation;
  return matrix;
}

/// Where the pixels of an id lie, and how many there are.
struct VisibleExtent {
  long pixels = 0;
  int left = 0, top = 0, right = 0, bottom = 0;  // half-open
};

std::map<std::uint16_t, VisibleExtent> visibleExtents(const std::vector<std::uint16_t>& segmentation, int width) {
  std::map<std::uint16_t, VisibleExtent> extents;
  for (std::size_t pixel = 0; pixel < segmentation.size(); ++pixel) {
    const int x = static_cast<int>(pixel % static_cast<std::size_t>(width));
    const int y = static_cast<int>(pixel / static_cast<std::size_t>(width));
    const auto [entry, isNew] = extents.try_emplace(segmentation[pixel], VisibleExtent{0, x, y, x + 1, y + 1});
    VisibleExtent& extent = entry->second;
    ++extent.pixels;
    extent.left = std::min(extent.left, x), extent.right = std::max(extent.right, x + 1);
    extent.bottom = y + 1;
  }
  return extents;
}

template <class Extent>
Json boxOf(const Extent& extent) {
  return {extent.left, extent.top, extent.right - extent.left, extent.bottom - extent.top};
}

const std::string& categoryOf(const Body& body) {
  return body.category;
}

/// Numbers of categories, from 1 on, in the order of the bodies.
std::map<std::string, int> numberCategories(const Scene& scene) {
  std::map<std::string, int> numbers;
  for (const Body& body : scene.bodies) numbers.try_emplace(categoryOf(body), static_cast<int>(numbers.size()) + 1);
  return numbers;
}

/// The box around a body along the axes of its frame; null for a plane.
Json boxInSpace(const Scene& scene, const Body& body, const RigidTransform& worldFromBody) {
  const Bounds local = localBounds(scene, body);
  if (local.isEmpty()) return nullptr;
  return {{"center", numbersOf(worldFromBody * Vec3(local.center()))},
          {"size", numbersOf(Vec3(local.sizes()))},
          {"orientation", quaternionOf(worldFromBody.rotation)}};
}

}  // namespace

std::string cameraJson(const std::vector<FrameCamera>& cameras) {
  Json frames = Json::array();
  for (const FrameCamera& camera : cameras) {
    const Eigen::Matrix4d openCv = matrixOf(camera.pinhole.worldFromCamera(), camera.pinhole.position());
    const Eigen::Matrix4d openGl = openCv * Eigen::Vector4d(1, -1, -1, 1).asDiagonal();
    frames.push_back({{"frame", camera.frame},
                      {"time", camera.time},
                      {"K", rowsOf(camera.pinhole.intrinsics())},
                      {"worldFromCamera", rowsOf(openGl)},
                      {"worldFromCameraOpenCV", rowsOf(openCv)}});
  }
  const Json file = {{"width", cameras.empty() ? 0 : cameras[0].pinhole.width()},
                     {"height", cameras.empty() ? 0 : cameras[0].pinhole.height()},
                     {"frames", frames}};
  return file.dump() + "\n";
}

std::string originJson(const std::string& trajectory, const std::string& stateHash) {
  return Json{{"trajectory", trajectory}, {"stateHash", stateHash}}.dump(-1, ' ', false,
                                                                         Json::error_handler_t::replace) +
         "\n";
}

std::string eventsJson(const std::vector<Event>& events, const Scene& scene) {
  const auto nameOfBody = [&](int body) {
    return body == kWorld ? Json(nullptr) : Json(scene.bodies[static_cast<std::size_t>(body)].name);
  };
  Json list = Json::array();
  for (const Event& event : events)
    list.push_back({{"time", event.time},
                    {"kind", eventKindName(event.kind)},
                    {"a", nameOfBody(event.bodyA)},
                    {"b", nameOfBody(event.bodyB)},
                    {"point", numbersOf(event.point)},
                    {"normal", numbersOf(event.normal)},
                    {"impulse", event.impulse}});
  return Json{{"events", list}}.dump() + "\n";
}

std::map<std::uint16_t, std::vector<long>> runLengths(const Segmentation& segmentation) {
  std::map<std::uint16_t, std::vector<long>> runs;
  std::map<std::uint16_t, long> ends;  // of an id's runs so far
  const std::size_t width = static_cast<std::size_t>(segmentation.width);
  const std::size_t height = static_cast<std::size_t>(segmentation.height), count = width * height;
  const auto idAt = [&](std::size_t place) { return segmentation.ids[place % height * width + place / height]; };
  for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
    const std::uint16_t id = idAt(begin);
    while (end < count && idAt(end) == id) ++end;
    runs[id].push_back(static_cast<long>(begin) - ends[id]);
    runs[id].push_back(static_cast<long>(end - begin));
    ends[id] = static_cast<long>(end);
  }
  for (auto& [id, lengths] : runs)
    if (const long rest = static_cast<long>(count) - ends[id]; rest > 0) lengths.push_back(rest);
  return runs;
}

std::string instancesJson(const Scene& scene, const Frame& frame, const std::vector<WholeExtent>& wholes,
                          const Segmentation& segmentation) {
  const std::vector<RigidTransform> places = placeBodies(scene, frame);
  const std::map<std::string, int> categories = numberCategories(scene);
  const std::map<std::uint16_t, VisibleExtent> visible = visibleExtents(segmentation.ids, segmentation.width);
  const std::map<std::uint16_t, std::vector<long>> runs = runLengths(segmentation);
  const std::vector<long> noRuns = {static_cast<long>(segmentation.ids.size())};
  Json annotations = Json::array();
  std::size_t moving = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const BodyState* state = body.motion == Motion::fixed ? nullptr : &frame.states[moving++];
    const WholeExtent& whole = wholes[i];
    if (whole.pixels == 0) continue;
    const std::uint16_t id = static_cast<std::uint16_t>(i + 1);
    const auto seen = visible.find(id);
    const VisibleExtent shown = seen == visible.end() ? VisibleExtent{} : seen->second;
    const Material& material = scene.materials[static_cast<std::size_t>(body.material)];
    annotations.push_back(
        {{"id", id},
         {"image_id", frame.number},
         {"category_id", categories.at(categoryOf(body))},
         {"category", categoryOf(body)},
         {"name", body.name},
         {"bbox", boxOf(shown)},
         {"area", shown.pixels},
         {"segmentation",
          {{"size", {segmentation.height, segmentation.width}},
           {"counts", seen == visible.end() ? noRuns : runs.at(id)}}},
         {"iscrowd", 0},
         {"wholeBox", boxOf(whole)},
         {"wholeArea", whole.pixels},
         {"visibleFraction", static_cast<double>(shown.pixels) / static_cast<double>(whole.pixels)},
         {"box3d", boxInSpace(scene, body, places[i])},
         {"worldFromBody", rowsOf(matrixOf(places[i].rotation.toRotationMatrix(), places[i].translation))},
         {"position", numbersOf(state != nullptr ? state->position : places[i] * body.massProperties.centerOfMass)},
         {"orientation", quaternionOf(places[i].rotation)},
         {"linearVelocity", numbersOf(state != nullptr ? state->linearVelocity : Vec3(Vec3::Zero()))},
         {"angularVelocity", numbersOf(state != nullptr ? state->angularVelocity : Vec3(Vec3::Zero()))},
         {"motion", body.motion == Motion::fixed    ? "static"
                    : body.motion == Motion::driven ? "driven"
                                                    : "dynamic"},
         {"mass", body.massProperties.mass},
         {"staticFriction", material.staticFriction},
         {"dynamicFriction", material.dynamicFriction},
         {"restitution", material.restitution}});
  }
  Json named = Json::array();
  std::vector<std::pair<int, std::string>> ordered;
  for (const auto& [name, number] : categories) ordered.emplace_back(number, name);
  std::sort(ordered.begin(), ordered.end());
  for (const auto& [number, name] : ordered) named.push_back({{"id", number}, {"name", name}});
  const Json file = {{"images",
                      {{{"id", frame.number},
                        {"time", frame.time},
                        {"width", segmentation.width},
                        {"height", segmentation.height},
                        {"file_name", fmt::format("frame_{:06}.png", frame.number)}}}},
                     {"categories", named},
                     {"annotations", annotations}};
  return file.dump() + "\n";
}

}  // namespace cradle
