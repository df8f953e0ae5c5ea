#include "verify/check_instances.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace cradle {
namespace {

// Of the size of a number that takes some operations; others have the same bits as in the trajectory or the scene.
constexpr double kPlaceOperations = 1e-14;

std::string listed(const BoxOfPixels& box) {
  return fmt::format("[{} {} {} {}]", box[0], box[1], box[2], box[3]);
}

/// Adds what a file is found to say, and what it should say.
class Comparison {
 public:
  Comparison(Aspect aspect, std::string file, Findings& findings)
      : aspect_(aspect), file_(std::move(file)), findings_(findings) {}

  /// What follows is of this thing.
  void beginThing(const std::string& thing) { thing_ = thing; }

  void addExact(const char* what, const std::string& found, const std::string& expected) const {
    add(what, found == expected ? 0 : 1, 0, found, expected);
  }
  void addExact(const char* what, long found, long expected) const {
    add(what, found == expected ? 0 : 1, 0, std::to_string(found), std::to_string(expected));
  }
  void addNumber(const char* what, double found, double expected, double tolerance = 0) const {
    add(what, relative(std::abs(found - expected), std::abs(expected)), tolerance, fmt::format("{:.17g}", found),
        fmt::format("{:.17g}", expected));
  }
  /// `size` is of what the numbers come from, beside themselves.
  template <class Numbers>
  void addNumbers(const char* what, const Numbers& found, const Numbers& expected, double tolerance = 0,
                  double size = 0) const {
    const auto words = [](const Numbers& numbers) {
      std::string text;
      for (Eigen::Index i = 0; i < numbers.size(); ++i)
        text += fmt::format("{}{:.12g}", text.empty() ? "" : " ", numbers(i));
      return "[" + text + "]";
    };
    add(what, relative((found - expected).norm(), expected.norm() + size), tolerance, words(found), words(expected));
  }
  void add(const char* what, double deviation, double tolerance, const std::string& found,
           const std::string& expected) const {
    findings_.add(aspect_, deviation, tolerance, [&] {
      return Fault{{file_}, fmt::format("{} {} of {}", what, found, thing_), expected};
    });
  }

 private:
  static double relative(double difference, double size) {
    return difference == 0 ? 0 : difference / std::max(size, 1e-300);
  }

  Aspect aspect_;
  std::string file_, thing_;
  Findings& findings_;
};

/// Pixels of an id, and their box; the box of none is all zeros.
struct Extent {
  long pixels = 0;
  BoxOfPixels box{};
};

Extent extentOf(const std::vector<bool>& mask, std::size_t width) {
  long left = std::numeric_limits<long>::max(), top = left, right = 0, bottom = 0;
  Extent extent;
  for (std::size_t pixel = 0; pixel < mask.size(); ++pixel) {
    if (!mask[pixel]) continue;
    const long x = static_cast<long>(pixel % width), y = static_cast<long>(pixel / width);
    ++extent.pixels;
    left = std::min(left, x), right = std::max(right, x + 1);
    top = std::min(top, y), bottom = std::max(bottom, y + 1);
  }
  if (extent.pixels > 0) extent.box = {left, top, right - left, bottom - top};
  return extent;
}

/// Half edges, and the middle, of the box around a body along its own axes.
struct BoxAround {
  Vec3 middle = Vec3::Zero(), size = Vec3::Zero();  // m, body's frame
};

std::optional<BoxAround> boxAround(const Scene& scene, const Shape& shape) {
  if (std::holds_alternative<Plane>(shape)) return std::nullopt;
  if (const auto* sphere = std::get_if<Sphere>(&shape))
    return BoxAround{Vec3::Zero(), Vec3::Constant(2 * sphere->radius)};
  if (const auto* box = std::get_if<Box>(&shape)) return BoxAround{Vec3::Zero(), box->size};
  if (const auto* c = std::get_if<Cylinder>(&shape))
    return BoxAround{Vec3::Zero(), {2 * c->radius, c->length, 2 * c->radius}};
  if (const auto* c = std::get_if<Capsule>(&shape))
    return BoxAround{Vec3::Zero(), {2 * c->radius, c->length + 2 * c->radius, 2 * c->radius}};
  const auto& vertices = scene.models[static_cast<std::size_t>(std::get<ModelShape>(shape).model)].drawn.vertices;
  Vec3 least = vertices.at(0), most = least;
  for (const Vec3& vertex : vertices) least = least.cwiseMin(vertex), most = most.cwiseMax(vertex);
  return BoxAround{(least + most) / 2, most - least};
}

class InstanceCheck {
 public:
  InstanceCheck(const VerifiedFilm& film, const TruthFrame& frame, Findings& findings)
      : film_(film),
        frame_(frame),
        comparison_(Aspect::instances, truthFileName("instances", frame.number), findings) {}

  void checkPicture();
  void checkAll();

 private:
  void checkMask(const InstanceRecord& record) const;
  void checkPlace(const InstanceRecord& record, std::size_t body) const;
  void checkState(const InstanceRecord& record, std::size_t body) const;
  void checkBody(const InstanceRecord& record, const Body& body) const;
  void checkBox(const InstanceRecord& record, std::size_t body) const;
  void checkEveryIdIsListed();
  void checkMasksAreApart();
  const BodyState* stateOf(std::size_t body) const;

  const VerifiedFilm& film_;
  const TruthFrame& frame_;
  Comparison comparison_;
};

void InstanceCheck::checkPicture() {
  const InstanceDocument& document = frame_.instances;
  comparison_.beginThing("the picture");
  comparison_.addExact("id", document.imageId, frame_.number);
  comparison_.addExact("width", document.width, film_.cameras.width);
  comparison_.addExact("height", document.height, film_.cameras.height);
  comparison_.addNumber("time", document.time, frame_.state.time);
  comparison_.addExact("file_name", document.pictureName, fmt::format("frame_{:06}.png", frame_.number));
}

void InstanceCheck::checkAll() {
  const std::size_t bodies = film_.scene.bodies.size();
  for (const InstanceRecord& record : frame_.instances.annotations) {
    comparison_.beginThing(fmt::format("annotation {} (\"{}\")", record.id, record.name));
    const bool isBody = record.id >= 1 && static_cast<std::size_t>(record.id) <= bodies;
    comparison_.add("id", isBody ? 0 : 1, 0, std::to_string(record.id), fmt::format("1 to {}", bodies));
    if (!isBody) continue;
    const std::size_t body = static_cast<std::size_t>(record.id - 1);
    checkMask(record);
    checkPlace(record, body);
    checkState(record, body);
    checkBody(record, film_.scene.bodies[body]);
    checkBox(record, body);
  }
  checkEveryIdIsListed();
  checkMasksAreApart();
}

/// Run lengths give the pixels of the id, and these the box and the area.
void InstanceCheck::checkMask(const InstanceRecord& record) const {
  const auto mask = maskOf(record, film_.width(), film_.height());
  comparison_.addExact("height of the mask", record.maskSize[0], film_.cameras.height);
  comparison_.addExact("width of the mask", record.maskSize[1], film_.cameras.width);
  comparison_.add("run lengths", mask ? 0 : 1, 0, "that are not those of the picture",
                  fmt::format("a sum of {}", film_.width() * film_.height()));
  if (!mask) return;
  long apart = 0;
  for (std::size_t pixel = 0; pixel < mask->size() && !frame_.segmentation.empty(); ++pixel)
    apart += (*mask)[pixel] != (frame_.segmentation[pixel] == record.id);
  comparison_.add("run lengths", static_cast<double>(apart), 0,
                  fmt::format("other than segmentation in {} pixels", apart),
                  "the mask of " + frame_.fileOf("segmentation"));
  const Extent extent = extentOf(*mask, film_.width());
  comparison_.addExact("bbox", listed(record.box), listed(extent.box));
  comparison_.addExact("area", record.area, extent.pixels);
  const double fraction = static_cast<double>(extent.pixels) / static_cast<double>(record.wholeArea);
  comparison_.addNumber("visibleFraction", record.visibleFraction, fraction, kPlaceOperations);
  comparison_.add("wholeArea", record.wholeArea >= std::max(record.area, 1L) ? 0 : 1, 0,
                  std::to_string(record.wholeArea), fmt::format("at least {}", record.area));
  const auto& [left, top, width, height] = record.wholeBox;
  const bool isAround = record.area == 0 || (left <= record.box[0] && top <= record.box[1] &&
                                             left + width >= record.box[0] + record.box[2] &&
                                             top + height >= record.box[1] + record.box[3]);
  const bool isInPicture =
      left >= 0 && top >= 0 && left + width <= film_.cameras.width && top + height <= film_.cameras.height;
  comparison_.add("wholeBox", isAround && isInPicture ? 0 : 1, 0, listed(record.wholeBox),
                  "a box in the picture around " + listed(record.box));
}

const BodyState* InstanceCheck::stateOf(std::size_t body) const {
  std::size_t before = 0;
  for (std::size_t i = 0; i < body; ++i) before += film_.scene.bodies[i].motion != Motion::fixed;
  return film_.scene.bodies[body].motion == Motion::fixed ? nullptr : &frame_.state.states[before];
}

void InstanceCheck::checkPlace(const InstanceRecord& record, std::size_t body) const {
  const RigidTransform& place = frame_.worldFromBody[body];
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = place.rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = place.translation;
  comparison_.addNumbers("worldFromBody", Eigen::Vector<double, 16>(record.worldFromBody.reshaped()),
                         Eigen::Vector<double, 16>(matrix.reshaped()), kPlaceOperations,
                         film_.scene.bodies[body].massProperties.centerOfMass.norm());
  comparison_.addNumbers("orientation", Eigen::Vector4d(record.orientation.coeffs()),
                         Eigen::Vector4d(place.rotation.coeffs()));
}

void InstanceCheck::checkState(const InstanceRecord& record, std::size_t body) const {
  const BodyState* state = stateOf(body);
  const RigidTransform& place = frame_.worldFromBody[body];
  const Vec3& centre = film_.scene.bodies[body].massProperties.centerOfMass;
  const Vec3 rest = Vec3::Zero();
  const Vec3 position = state != nullptr ? state->position : Vec3(place.rotation * centre + place.translation);
  comparison_.addNumbers("position", record.position, position, kPlaceOperations, centre.norm());
  comparison_.addNumbers("linearVelocity", record.linearVelocity, state != nullptr ? state->linearVelocity : rest);
  comparison_.addNumbers("angularVelocity", record.angularVelocity, state != nullptr ? state->angularVelocity : rest);
}

void InstanceCheck::checkBody(const InstanceRecord& record, const Body& body) const {
  const Material& material = film_.scene.materials[static_cast<std::size_t>(body.material)];
  const char* motion = body.motion == Motion::fixed ? "static" : body.motion == Motion::driven ? "driven" : "dynamic";
  comparison_.addExact("name", record.name, body.name);
  comparison_.addExact("category", record.category, body.category);
  comparison_.addExact("motion", record.motion, motion);
  comparison_.addExact("image_id", record.imageId, frame_.number);
  comparison_.addExact("iscrowd", record.isCrowd, 0);
  const auto& categories = frame_.instances.categories;
  const long named = std::count_if(categories.begin(), categories.end(), [&](const CategoryRecord& category) {
    return category.id == record.categoryId && category.name == body.category;
  });
  comparison_.add("category_id", named == 1 ? 0 : 1, 0, std::to_string(record.categoryId),
                  fmt::format("the number of \"{}\" in categories", body.category));
  comparison_.addNumber("mass", record.mass, body.massProperties.mass);
  comparison_.addNumber("staticFriction", record.staticFriction, material.staticFriction);
  comparison_.addNumber("dynamicFriction", record.dynamicFriction, material.dynamicFriction);
  comparison_.addNumber("restitution", record.restitution, material.restitution);
}

void InstanceCheck::checkBox(const InstanceRecord& record, std::size_t body) const {
  const auto expected = boxAround(film_.scene, film_.scene.bodies[body].shape);
  comparison_.addExact("number of box3d", record.boxInSpace.has_value(), expected.has_value());
  if (!record.boxInSpace || !expected) return;
  const RigidTransform& place = frame_.worldFromBody[body];
  const Vec3 middle = place.rotation.toRotationMatrix() * expected->middle + place.translation;
  const double size = expected->size.norm() + expected->middle.norm();
  comparison_.addNumbers("centre of box3d", record.boxInSpace->center, middle, kPlaceOperations, size);
  comparison_.addNumbers("size of box3d", record.boxInSpace->size, expected->size, kPlaceOperations, size);
  comparison_.addNumbers("orientation of box3d", Eigen::Vector4d(record.boxInSpace->orientation.coeffs()),
                         Eigen::Vector4d(place.rotation.coeffs()));
}

/// Each body has at most one annotation, and one if any pixel shows it.
void InstanceCheck::checkEveryIdIsListed() {
  const std::size_t bodies = film_.scene.bodies.size();
  std::vector<long> shown(bodies), records(bodies);
  for (const int id : frame_.ids)
    if (id >= 1 && static_cast<std::size_t>(id) <= bodies) ++shown[static_cast<std::size_t>(id - 1)];
  for (const InstanceRecord& record : frame_.instances.annotations)
    if (record.id >= 1 && static_cast<std::size_t>(record.id) <= bodies)
      ++records[static_cast<std::size_t>(record.id - 1)];
  for (std::size_t i = 0; i < bodies; ++i) {
    comparison_.beginThing(fmt::format("body \"{}\" ({})", film_.scene.bodies[i].name, i + 1));
    const bool isRight = records[i] == 1 || (records[i] == 0 && shown[i] == 0);
    comparison_.add("number of annotations", isRight ? 0 : 1, 0, std::to_string(records[i]), "one, for it is seen");
  }
}

/// No pixel is of two bodies.
void InstanceCheck::checkMasksAreApart() {
  long claimed = 0, visible = 0;
  for (const InstanceRecord& record : frame_.instances.annotations) claimed += record.area;
  for (const int id : frame_.ids) visible += id >= 1 && id < kFirstIdOfLinks;
  comparison_.beginThing("all annotations");
  comparison_.addExact("sum of areas", claimed, visible);
}

}  // namespace

void checkInstances(const VerifiedFilm& film, const TruthFrame& frame, Findings& findings) {
  InstanceCheck check(film, frame, findings);
  check.checkPicture();
  check.checkAll();
}

void checkEvents(const VerifiedFilm& film, const std::vector<EventRecord>& records, Findings& findings) {
  const std::vector<Event> events = film.trajectory.events();
  Comparison comparison(Aspect::events, "events.json", findings);
  comparison.beginThing("the film");
  comparison.addExact("number of events", std::ssize(records), std::ssize(events));
  const auto nameOfBody = [&](int body) {
    return body == kWorld ? "the world" : "\"" + film.scene.bodies[static_cast<std::size_t>(body)].name + "\"";
  };
  const auto nameOfRecord = [](const std::optional<std::string>& body) {
    return body ? "\"" + *body + "\"" : "the world";
  };
  for (std::size_t i = 0; i < std::min(records.size(), events.size()); ++i) {
    comparison.beginThing(fmt::format("event {}", i));
    comparison.addNumber("time", records[i].time, events[i].time);
    comparison.addExact("kind", records[i].kind, eventKindName(events[i].kind));
    comparison.addExact("a", nameOfRecord(records[i].bodyA), nameOfBody(events[i].bodyA));
    comparison.addExact("b", nameOfRecord(records[i].bodyB), nameOfBody(events[i].bodyB));
    comparison.addNumbers("point", records[i].point, events[i].point);
    comparison.addNumbers("normal", records[i].normal, events[i].normal);
    comparison.addNumber("impulse", records[i].impulse, events[i].impulse);
  }
}

}  // namespace cradle
