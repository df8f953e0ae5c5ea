#include "verify/truth_documents.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/read_file.h"

namespace cradle {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kLongestDocument = 2'000'000'000;  // bytes: cameras of a million frames take 500 MB

/// Reads a file by parse(document).
template <class Parse>
auto readDocument(const std::string& path, const Parse& parse) {
  const std::string text = readFile(path, kLongestDocument, ErrorKind::usage);
  try {
    return parse(Json::parse(text));
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorKind::usage, path,
                fmt::format("cannot be read: {}; draw it again with `cradle render --overwrite`", error.what()));
  }
}

/// An array of this many numbers; throws as at() does where there are others.
template <class Number, std::size_t count>
std::array<Number, count> arrayOf(const Json& json) {
  if (json.size() != count) static_cast<void>(json.at(std::max(json.size(), count)));
  return json.get<std::array<Number, count>>();
}

Vec3 vectorOf(const Json& json) {
  const auto [x, y, z] = arrayOf<double, 3>(json);
  return {x, y, z};
}

Quat turnOf(const Json& json) {
  const auto [w, x, y, z] = arrayOf<double, 4>(json);
  return {w, x, y, z};
}

template <int size>
Eigen::Matrix<double, size, size> squareOf(const Json& json) {
  const auto rows = arrayOf<std::array<double, size>, size>(json);
  Eigen::Matrix<double, size, size> matrix;
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column)
      matrix(row, column) = rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
  return matrix;
}

std::optional<std::string> nameIn(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<std::string>());
}

CameraRecord cameraOf(const Json& json) {
  return {json.at("frame").get<long>(), json.at("time").get<double>(), squareOf<3>(json.at("K")),
          squareOf<4>(json.at("worldFromCamera")), squareOf<4>(json.at("worldFromCameraOpenCV"))};
}

std::optional<BoxRecord> boxIn(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return BoxRecord{vectorOf(json.at("center")), vectorOf(json.at("size")), turnOf(json.at("orientation"))};
}

InstanceRecord instanceOf(const Json& json) {
  InstanceRecord record;
  record.id = json.at("id").get<long>();
  record.imageId = json.at("image_id").get<long>();
  record.categoryId = json.at("category_id").get<long>();
  record.isCrowd = json.at("iscrowd").get<long>();
  record.category = json.at("category").get<std::string>();
  record.name = json.at("name").get<std::string>();
  record.motion = json.at("motion").get<std::string>();
  record.box = arrayOf<long, 4>(json.at("bbox"));
  record.wholeBox = arrayOf<long, 4>(json.at("wholeBox"));
  record.area = json.at("area").get<long>();
  record.wholeArea = json.at("wholeArea").get<long>();
  record.maskSize = arrayOf<long, 2>(json.at("segmentation").at("size"));
  record.runs = json.at("segmentation").at("counts").get<std::vector<long>>();
  record.visibleFraction = json.at("visibleFraction").get<double>();
  record.boxInSpace = boxIn(json.at("box3d"));
  record.worldFromBody = squareOf<4>(json.at("worldFromBody"));
  record.position = vectorOf(json.at("position"));
  record.orientation = turnOf(json.at("orientation"));
  record.linearVelocity = vectorOf(json.at("linearVelocity"));
  record.angularVelocity = vectorOf(json.at("angularVelocity"));
  record.mass = json.at("mass").get<double>();
  record.staticFriction = json.at("staticFriction").get<double>();
  record.dynamicFriction = json.at("dynamicFriction").get<double>();
  record.restitution = json.at("restitution").get<double>();
  return record;
}

Json numberOrNull(double number) {
  return std::isfinite(number) ? Json(number) : Json(nullptr);
}

Json faultJson(const Tally& tally) {
  if (!tally.fault) return nullptr;
  const auto& [place, found, expected] = *tally.fault;
  const Json pixel = place.x < 0 ? Json(nullptr) : Json{place.x, place.y};
  return {{"file", place.file}, {"pixel", pixel}, {"found", found}, {"expected", expected}};
}

}  // namespace

TruthOrigin readOrigin(const std::string& path) {
  return readDocument(path, [](const Json& json) {
    return TruthOrigin{json.at("trajectory").get<std::string>(), json.at("stateHash").get<std::string>()};
  });
}

CameraDocument readCameras(const std::string& path) {
  return readDocument(path, [](const Json& json) {
    CameraDocument document{json.at("width").get<long>(), json.at("height").get<long>(), {}};
    for (const Json& camera : json.at("frames")) document.frames.push_back(cameraOf(camera));
    return document;
  });
}

std::vector<EventRecord> readEvents(const std::string& path) {
  return readDocument(path, [](const Json& json) {
    std::vector<EventRecord> events;
    for (const Json& event : json.at("events"))
      events.push_back({event.at("time").get<double>(), event.at("kind").get<std::string>(), nameIn(event.at("a")),
                        nameIn(event.at("b")), vectorOf(event.at("point")), vectorOf(event.at("normal")),
                        event.at("impulse").get<double>()});
    return events;
  });
}

InstanceDocument readInstances(const std::string& path) {
  return readDocument(path, [](const Json& json) {
    const Json& image = json.at("images").at(0);
    InstanceDocument document{image.at("id").get<long>(),
                              image.at("width").get<long>(),
                              image.at("height").get<long>(),
                              image.at("time").get<double>(),
                              image.at("file_name").get<std::string>(),
                              {},
                              {}};
    for (const Json& category : json.at("categories"))
      document.categories.push_back({category.at("id").get<long>(), category.at("name").get<std::string>()});
    for (const Json& annotation : json.at("annotations")) document.annotations.push_back(instanceOf(annotation));
    return document;
  });
}

std::string findingsJson(const Findings& findings, long frames) {
  Json checks = Json::array();
  for (std::size_t i = 0; i < kAspects; ++i) {
    const Aspect aspect = static_cast<Aspect>(i);
    const Tally& tally = findings.of(aspect);
    if (tally.values == 0) continue;
    checks.push_back({{"check", nameOf(aspect)},
                      {"values", tally.values},
                      {"faults", tally.faults},
                      {"worst", numberOrNull(tally.deviation)},
                      {"allowed", tally.tolerance},
                      {"unit", unitOf(aspect)},
                      {"fault", faultJson(tally)}});
  }
  return Json{{"frames", frames}, {"holds", findings.hold()}, {"checks", checks}}.dump(
             1, ' ', true, nlohmann::json::error_handler_t::replace) +
         "\n";
}

}  // namespace cradle
