#include "player/player_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <vector>

#include "core/error.h"
#include "core/interruption.h"
#include "core/json_numbers.h"
#include "core/printable.h"
#include "film/film_view.h"
#include "film/joint_parts.h"
#include "player/packed_numbers.h"
#include "render/appearance.h"
#include "render/body_place.h"
#include "render/link_items.h"
#include "trajectory/state_hash.h"

namespace cradle {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMaxBytes = 256e6;    // of states and forces; a browser holds some 500 MB of text
constexpr double kSameTime = 1e-12;    // of two frames, relative, as in comparisons of trajectories
constexpr double kCoilOfRod = 5;       // radius of a spring's coil, in those of a rod
constexpr double kPixelsOfSize = 300;  // how finely round things are divided

Json poseNumbers(const Vec3& place, const Quat& orientation) {
  return {place.x(), place.y(), place.z(), orientation.w(), orientation.x(), orientation.y(), orientation.z()};
}

void requireFits(const TrajectoryReader& reader, double bytes) {
  if (bytes > kMaxBytes)
    throw Error(ErrorKind::limit, reader.path(),
                fmt::format("has more than a page holds: {:.0f} MB of states, or of forces, and allowed are {:.0f} MB; "
                            "simulate with fewer frames per second, or export FILE.glb",
                            bytes / 1e6, kMaxBytes / 1e6));
}

/// What a thing is painted with.
struct Paint {
  Vec3f color;  // linear
  Pattern pattern;
  float cell;  // m
  Vec3f patternColor;
};

class PlayerDocument {
 public:
  explicit PlayerDocument(FilmSource& motion)
      : motion_(motion),
        reader_(motion.reader()),
        scene_(motion.scene()),
        view_(viewOf(motion, motion.scene().output.width, motion.scene().output.height)),
        appearance_(makeAppearance(motion.drawnScene(), view_, kPixelsOfSize / view_.size())) {}

  Json build(const std::function<void(long done)>& progress);

  /// Adds another run of the same bodies.
  void addOther(const TrajectoryReader& other, Json& document) const;

 private:
  static std::vector<double> statesOf(const TrajectoryReader& reader, const std::function<void(const Frame&)>& visit);
  /// Forces are known as B feels them: 1 if they are shown on B, -1 if on A, as B does not move.
  double signOf(int bodyB) const { return bodyB < 0 || moves(bodyB) ? 1 : -1; }
  bool moves(int body) const { return scene_.bodies[static_cast<std::size_t>(body)].motion != Motion::fixed; }
  Vec3 fromReference(int body, const Vec3& point) const;
  Paint paintOf(const Surface& surface) const;
  int unitShape(const char* kind);
  int meshShape(const BodyAppearance& look);
  Json meshOf(const DrawnMesh& mesh, const std::vector<BodyPart>& parts, bool hasTints) const;
  void addThing(int shape, int body, const RigidTransform& bodyFromThing, const Vec3& scale, const Paint& paint,
                bool hasTints = false);
  void addBodies();
  void addBody(int number);
  void addJoints(double radius);
  template <class Links>
  Json endsOf(const Links& links) const;
  Json eventsOf() const;
  void addForces(Json& document) const;
  void addCamera(Json& document) const;
  void addGround(Json& document) const;
  double coilLength() const;

  FilmSource& motion_;
  const TrajectoryReader& reader_;
  const Scene& scene_;
  const View view_;
  const Appearance appearance_;
  Json shapes_ = Json::array(), things_ = Json::array(), bodies_ = Json::array(), moving_ = Json::array();
  std::map<std::string, int> shapeNumbers_;  // by what they are
  SliderReach reach_;
};

/// A point of a body's frame, from its centre of mass if it moves.
Vec3 PlayerDocument::fromReference(int body, const Vec3& point) const {
  if (body == kWorld || !moves(body)) return point;
  return point - scene_.bodies[static_cast<std::size_t>(body)].massProperties.centerOfMass;
}

Paint PlayerDocument::paintOf(const Surface& surface) const {
  Vec3f color = surface.color;
  if (surface.texture >= 0)
    color = color.cwiseProduct(appearance_.textures[static_cast<std::size_t>(surface.texture)].mean);
  return {color, surface.pattern, surface.patternCell, surface.patternColor};
}

int PlayerDocument::unitShape(const char* kind) {
  const auto [found, isNew] = shapeNumbers_.try_emplace(kind, static_cast<int>(shapes_.size()));
  if (isNew) shapes_.push_back({{"kind", kind}});
  return found->second;
}

/// Vertices that parts of several colours share are there for each.
Json PlayerDocument::meshOf(const DrawnMesh& mesh, const std::vector<BodyPart>& parts, bool hasTints) const {
  std::vector<float> positions, normals, tints;
  std::vector<std::uint32_t> triangles;
  for (const BodyPart& part : parts) {
    std::map<std::uint32_t, std::uint32_t> numbers;
    const Vec3f tint = paintOf(part.surface).color;
    for (std::uint32_t t = part.firstTriangle; t < part.firstTriangle + part.triangleCount; ++t)
      for (const auto corner : mesh.triangles[t]) {
        const auto vertex = static_cast<std::uint32_t>(corner);
        const auto [known, isNew] = numbers.try_emplace(vertex, static_cast<std::uint32_t>(positions.size() / 3));
        triangles.push_back(known->second);
        if (!isNew) continue;
        for (const double x : mesh.vertices[vertex]) positions.push_back(static_cast<float>(x));
        for (const float x : mesh.normals[vertex]) normals.push_back(x);
        for (const float x : tint) tints.push_back(x);
      }
  }
  Json json = {{"kind", "mesh"},
               {"positions", packed(positions)},
               {"normals", packed(normals)},
               {"triangles", packed(triangles)}};
  if (hasTints) json["tints"] = packed(tints);
  return json;
}

bool haveOneColor(const std::vector<BodyPart>& parts) {
  return std::all_of(parts.begin(), parts.end(),
                     [&](const BodyPart& part) { return part.surface == parts.front().surface; });
}

int PlayerDocument::meshShape(const BodyAppearance& look) {
  const bool hasTints = !haveOneColor(look.parts);
  std::string key;
  for (const BodyPart& part : look.parts) {
    CRADLE_CHECK(part.mesh == look.parts.front().mesh);
    key += fmt::format("{} {} {} ", part.mesh, part.firstTriangle, part.triangleCount);
    const Vec3f tint = paintOf(part.surface).color;
    if (hasTints) key += fmt::format("{} {} {} ", tint.x(), tint.y(), tint.z());
  }
  const auto [found, isNew] = shapeNumbers_.try_emplace(key, static_cast<int>(shapes_.size()));
  if (isNew) {
    const auto mesh = static_cast<std::size_t>(look.parts.front().mesh);
    shapes_.push_back(meshOf(appearance_.meshes[mesh], look.parts, hasTints));
  }
  return found->second;
}

void PlayerDocument::addThing(int shape, int body, const RigidTransform& bodyFromThing, const Vec3& scale,
                              const Paint& paint, bool hasTints) {
  things_.push_back({{"shape", shape},
                     {"body", body},
                     {"local", poseNumbers(fromReference(body, bodyFromThing.translation), bodyFromThing.rotation)},
                     {"scale", numbersOf(scale)},
                     {"color", numbersOf(paint.color)},
                     {"pattern", {static_cast<int>(paint.pattern), std::max(paint.cell, 1e-9f), hasTints ? 1 : 0}},
                     {"patternColor", numbersOf(paint.patternColor)}});
}

void PlayerDocument::addBody(int number) {
  const auto index = static_cast<std::size_t>(number);
  const Body& body = scene_.bodies[index];
  const BodyAppearance& look = appearance_.bodies[index];
  const RigidTransform here{Quat::Identity(), Vec3::Zero()};
  if (look.isDrawnAsSphere && look.sphere)
    return addThing(unitShape("sphere"), number, {Quat::Identity(), look.sphere->center},
                    Vec3::Constant(look.sphere->radius), paintOf(look.surface));
  if (look.cylinder)
    return addThing(unitShape("cylinder"), number, here,
                    Vec3(look.cylinder->radius, look.cylinder->length, look.cylinder->radius), paintOf(look.surface));
  if (const auto* box = std::get_if<Box>(&body.shape))
    return addThing(unitShape("box"), number, here, box->size, paintOf(look.surface));
  if (look.parts.empty()) return;
  const bool hasTints = !haveOneColor(look.parts);
  Paint paint = paintOf(look.parts.front().surface);
  if (hasTints) paint.color = Vec3f::Ones();
  addThing(meshShape(look), number, here, Vec3::Ones(), paint, hasTints);
}

void PlayerDocument::addBodies() {
  for (int number = 0; number < static_cast<int>(scene_.bodies.size()); ++number) {
    const Body& body = scene_.bodies[static_cast<std::size_t>(number)];
    Json json = {{"name", body.name}, {"mass", body.massProperties.mass}};
    if (moves(number))
      moving_.push_back(number);
    else
      json["place"] = poseNumbers(body.worldFromBody.translation, body.worldFromBody.rotation);
    bodies_.push_back(std::move(json));
    addBody(number);
  }
}

void PlayerDocument::addJoints(double radius) {
  std::vector<JointPart> parts = jointParts(scene_, radius);
  const std::vector<JointPart> rails = railParts(scene_, reach_, radius);
  parts.insert(parts.end(), rails.begin(), rails.end());
  for (const JointPart& part : parts)
    addThing(unitShape(part.kind == JointPartKind::ball ? "sphere" : "cylinder"), part.body, part.bodyFromPart,
             part.scale, paintOf(part.kind == JointPartKind::rail ? kSteel : kDarkSteel));
}

template <class Links>
Json PlayerDocument::endsOf(const Links& links) const {
  Json all = Json::array();
  for (const auto& link : links) {
    Json ends = Json::array();
    for (const Anchor* anchor : {&link.anchorA, &link.anchorB}) {
      ends.push_back(anchor->body);
      for (const double x : fromReference(anchor->body, anchor->point)) ends.push_back(x);
    }
    all.push_back(std::move(ends));
  }
  return all;
}

/// The states of all frames, each of which is shown to `visit`.
std::vector<double> PlayerDocument::statesOf(const TrajectoryReader& reader,
                                             const std::function<void(const Frame&)>& visit) {
  std::vector<double> states;
  for (long number = 0; number < reader.frameCount(); ++number) {
    const Frame frame = reader.readFrame(number);
    for (const BodyState& state : frame.states)
      for (const double x : stateNumbers(state)) states.push_back(x);
    visit(frame);
  }
  return states;
}

Json PlayerDocument::eventsOf() const {
  const auto nameOf = [this](int body) {
    return body < 0 ? std::string("the world") : scene_.bodies[static_cast<std::size_t>(body)].name;
  };
  Json all = Json::array();
  for (const Event& event : reader_.events())
    all.push_back({{"time", event.time},
                   {"kind", eventKindName(event.kind)},
                   {"names", event.bodyB < 0 ? nameOf(event.bodyA) : nameOf(event.bodyA) + ", " + nameOf(event.bodyB)},
                   {"point", numbersOf(event.point)},
                   {"normal", numbersOf(Vec3(signOf(event.bodyB) * event.normal))},
                   {"impulse", event.impulse}});
  return all;
}

void PlayerDocument::addForces(Json& document) const {
  std::vector<std::uint32_t> first = {0};
  std::vector<float> forces;
  for (long number = 0; number < reader_.frameCount(); ++number) {
    if (reader_.hasContacts())
      for (const ContactWrench& wrench : reader_.contactsAt(number)) {
        for (const double x : wrench.force) forces.push_back(static_cast<float>(signOf(wrench.bodyB) * x));
        for (const double x : wrench.point) forces.push_back(static_cast<float>(x));
      }
    requireFits(reader_, static_cast<double>(sizeof(float) * forces.size()));
    first.push_back(static_cast<std::uint32_t>(forces.size() / 6));
  }
  document["forces"] = packed(forces), document["firstForces"] = packed(first);
}

void PlayerDocument::addCamera(Json& document) const {
  const Camera camera = cameraOf(motion_, view_).at(motion_.drawnFrameAt(0));
  document["camera"] = {{"position", numbersOf(camera.position)},
                        {"target", numbersOf(camera.target)},
                        {"up", numbersOf(camera.up)},
                        {"aspect", static_cast<double>(scene_.output.width) / scene_.output.height},
                        {"verticalFieldOfView", camera.verticalFieldOfView * 180 / std::numbers::pi}};
}

void PlayerDocument::addGround(Json& document) const {
  document["ground"] = nullptr;
  if (!appearance_.ground) return;
  const Ground& ground = *appearance_.ground;
  document["ground"] = {{"normal", numbersOf(ground.normal)},
                        {"point", numbersOf(ground.point)},
                        {"light", numbersOf(ground.lightColor)},
                        {"dark", numbersOf(ground.darkColor)},
                        {"square", ground.squareSize}};
}

/// m, of the first spring at the start.
double PlayerDocument::coilLength() const {
  if (scene_.springs.empty()) return 1;
  const Spring& spring = scene_.springs.front();
  const std::vector<RigidTransform> places = placeBodies(scene_, reader_.readFrame(0));
  return std::max((worldPoint(spring.anchorA, places) - worldPoint(spring.anchorB, places)).norm(), 1e-9);
}

Json PlayerDocument::build(const std::function<void(long done)>& progress) {
  std::vector<double> energies;
  const std::vector<double> states = statesOf(reader_, [&](const Frame& frame) {
    const EnergyBalance& energy = frame.energy;
    energies.insert(energies.end(), {energy.kinetic, energy.potential, energy.dissipated, energy.work});
    include(frame, scene_, reach_);
    progress(frame.number + 1);
  });
  addBodies();
  const double radius = linkRadius(scene_, view_.bounds);
  addJoints(radius);
  const Quat fromWorld = motion_.worldFromDrawn().conjugate();
  const std::string& method = reader_.header().method;
  Json document = {
      {"method", printableLine(method.substr(0, method.find('\n')))},
      {"playbackSpeed", scene_.output.playbackSpeed},
      {"uprightFromWorld", {fromWorld.w(), fromWorld.x(), fromWorld.y(), fromWorld.z()}},
      {"size", view_.size()},
      {"middle", numbersOf(Vec3(view_.bounds.center()))},
      {"linkRadius", radius},
      {"colors",
       {{"rod", numbersOf(kSteel.color)}, {"spring", numbersOf(kDarkSteel.color)}, {"rope", numbersOf(kHemp.color)}}},
      {"coilRadius", kCoilOfRod * radius},
      {"coilLength", coilLength()},
      {"times", packed(reader_.frameTimes())},
      {"states", packed(states)},
      {"energies", packed(energies)},
      {"springs", endsOf(scene_.springs)},
      {"rods", endsOf(scene_.rods)},
      {"ropes", endsOf(scene_.ropes)},
      {"events", eventsOf()}};
  addForces(document), addCamera(document), addGround(document);
  document["bodies"] = std::move(bodies_), document["moving"] = std::move(moving_);
  document["shapes"] = std::move(shapes_), document["things"] = std::move(things_);
  return document;
}

void PlayerDocument::addOther(const TrajectoryReader& other, Json& document) const {
  const auto namesOf = [](const TrajectoryReader& reader) {
    std::vector<std::string> names;
    for (const BodyRecord& body : reader.header().bodies)
      if (body.hasStates()) names.push_back(body.name);
    return names;
  };
  if (namesOf(other) != namesOf(reader_))
    throw Error(ErrorKind::usage, other.path(),
                fmt::format("has other bodies that move than {}; one page shows runs of the same", reader_.path()));
  const auto isSame = [](double a, double b) { return std::abs(a - b) <= kSameTime * (1 + std::abs(a)); };
  if (!std::ranges::equal(reader_.frameTimes(), other.frameTimes(), isSame))
    throw Error(ErrorKind::usage, other.path(),
                fmt::format("has frames at other times than {}; one page shows runs with the same", reader_.path()));
  document["other"] = {{"name", std::filesystem::path(other.path()).filename().string()},
                       {"states", packed(statesOf(other, [](const Frame&) { throwIfInterrupted(); }))}};
}

/// Before memory is taken for them.
void requireStatesFit(const TrajectoryReader& reader, int runs) {
  if (reader.frameCount() == 0) throw Error(ErrorKind::usage, reader.path(), "has no frames yet");
  const auto& bodies = reader.header().bodies;
  const auto moving = std::ranges::count_if(bodies, [](const BodyRecord& body) { return body.hasStates(); });
  requireFits(reader, 8.0 * 13 * runs * static_cast<double>(moving) * static_cast<double>(reader.frameCount()));
}

}  // namespace

std::string playerDocument(FilmSource& motion, const TrajectoryReader* other,
                           const std::function<void(long done)>& progress) {
  requireStatesFit(motion.reader(), other ? 2 : 1);
  PlayerDocument player(motion);
  Json document = player.build(progress);
  if (other) player.addOther(*other, document);
  std::string text;
  for (const char c : document.dump(-1, ' ', true, Json::error_handler_t::replace))
    c == '<' ? text += "\\u003c" : text += c;
  return text;
}

}  // namespace cradle
