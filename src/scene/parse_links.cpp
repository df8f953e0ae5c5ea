#include "scene/parse_links.h"

#include <fmt/format.h>

#include <cmath>

#include "math/rotation.h"
#include "scene/parse_copies.h"
#include "scene/parse_pose.h"
#include "scene/picked_points.h"

namespace cradle {
namespace {

constexpr double kMaxVertices = 2147483647;  // vertex indices are int
constexpr double kLikelyDegrees = 10;        // rad: limits beyond them are rarely meant, and 10 degrees and more often
constexpr int kMaxDirections = 1000;         // of a body: so many take 1 s and 150 MB at the start of a run

/// Whether no force moves it.
bool isFixed(int body, const Scene& scene) {
  return body == kWorld || scene.bodies[static_cast<std::size_t>(body)].motion != Motion::dynamic;
}

/// An end that is a vertex of a mesh, the vertex nearest to a point, or what a pixel shows.
void parseFoundAnchor(const Field& field, const SceneDraft& scene, FaultList& faults, AnchorDraft& draft) {
  const std::size_t faultsBefore = faults.count();
  const int body = draft.anchor.body;
  ObjectReader reader(field, faults);
  const auto vertex = reader.find("vertex"), nearest = reader.find("nearestVertex"), pick = reader.find("pick");
  if (vertex) draft.vertex = static_cast<int>(reader.number("vertex", {0, kMaxVertices, false, true}, "", 0));
  if (nearest) draft.nearestTo = readVector(*nearest, kCoordinates, "m", faults);
  if (pick) draft.pick = parsePick(*pick, faults);
  if (!vertex && !nearest && !pick)
    reader.addMissing(
        {"vertex", "nearestVertex", "pick"},
        "the anchor names no point; give [x, y, z], a \"vertex\" by its number, the \"nearestVertex\" to a "
        "point, or a \"pick\" from a picture");
  if ((vertex && nearest) || ((vertex || nearest) && pick))
    addFault(faults, field,
             fmt::format("both {} are given; allowed is one of them",
                         reader.keysFound({"vertex", "nearestVertex", "pick"})));
  reader.rejectUnknownKeys();
  const bool isSound = faults.count() == faultsBefore;
  const bool hasVertices =
      body != kWorld && scene.bodies[scene.draftOfBody[static_cast<std::size_t>(body)]].meshField.has_value();
  if (isSound && draft.isOfMesh() && !hasVertices)
    addFault(faults, field, "only the vertices of a mesh can be anchors; give a point [x, y, z]");
  if (isSound && draft.pick && body == kWorld)
    addFault(faults, field, "a point of the world cannot be picked; give a point [x, y, z], or the end a body");
  if (faults.count() != faultsBefore) draft.vertex.reset(), draft.nearestTo.reset(), draft.pick.reset();
}

AnchorDraft parseAnchor(ObjectReader& reader, const char* key, int body, const Vec3& fallback,
                        const SceneDraft& scene) {
  AnchorDraft draft{{body, fallback}, reader.field()};
  const auto field = reader.find(key);
  if (!field) return draft;
  draft.field = *field;
  if (std::holds_alternative<JsonValue::Object>(field->value->content)) {
    parseFoundAnchor(*field, scene, reader.faults(), draft);
  } else {
    draft.anchor.point = readVector(*field, kCoordinates, "m", reader.faults()).value_or(fallback);
  }
  return draft;
}

void checkBodies(ObjectReader& reader, std::optional<int> bodyA, std::optional<int> bodyB, const Scene& scene) {
  if (!bodyA || !bodyB) return;
  if (bodyA == bodyB) {
    addFault(reader.faults(), reader.find("bodyB").value_or(reader.field()),
             "bodyA and bodyB are the same body; they must differ, or leave out bodyB for a point of the world");
  } else if (isFixed(*bodyA, scene) && isFixed(*bodyB, scene)) {
    addFault(reader.faults(), reader.field(), "neither end can move; at least one body must be dynamic");
  }
}

const BodyDraft& draftOf(int body, const SceneDraft& scene) {
  return scene.bodies[scene.draftOfBody[static_cast<std::size_t>(body)]];
}

/// Whether a body is a copy, and so is named with its number.
bool isNumbered(int body, const SceneDraft& scene) {
  return body != kWorld && scene.scene.bodies[static_cast<std::size_t>(body)].name != draftOf(body, scene).body.name;
}

/// The body that copy `number` of a link ties in place of `body`: of as many copies, the one with that number; of
/// copies that are tied from another one on, as in a chain, the one that is as far from that. Nothing if it stays.
std::optional<int> bodyOfCopy(int body, const Copies& copies, int number, const SceneDraft& scene) {
  if (!isNumbered(body, scene)) return std::nullopt;
  const BodyDraft& draft = draftOf(body, scene);
  if (body == draft.firstBody && draft.bodyCount == copies.total()) return body + number;
  const std::optional<int> beside = draft.copies.numberBeside(body - draft.firstBody, copies, number);
  return beside ? std::optional(draft.firstBody + *beside) : std::nullopt;
}

/// Of a link that is copied from a numbered copy on: its copies must not go beyond the last one.
void checkChain(const Field& name, int body, const Copies& copies, const SceneDraft& scene, FaultList& faults) {
  if (copies.total() <= 1 || !isNumbered(body, scene)) return;
  if (bodyOfCopy(body, copies, static_cast<int>(copies.total()) - 1, scene)) return;
  const BodyDraft& draft = draftOf(body, scene);
  const int number = body - draft.firstBody;
  const std::string others = inQuotes(draft.body.name);
  if (copies.ring || draft.copies.ring) {
    addFault(faults, name,
             fmt::format("copies of what ties copy {} of {} go on from there, and are not in a ring of as many; give "
                         "both the same \"copies\", or tie a body that has none",
                         number, others));
    return;
  }
  const auto place = draft.copies.placeOf(number);
  addFault(
      faults, name,
      fmt::format("copies of what ties copy {} of {} go on from there, to copies that there are not; allowed is a "
                  "count of at most [{}, {}, {}]; take fewer, begin at an earlier copy, or tie a body that has none",
                  number, others, draft.copies.count[0] - place[0], draft.copies.count[1] - place[1],
                  draft.copies.count[2] - place[2]));
}

/// The body of a name, or of its first copy if the link is copied with it.
std::optional<int> findEnd(const Field& name, const Copies& copies, const SceneDraft& scene, FaultList& faults) {
  const auto* text = std::get_if<std::string>(&name.value->content);
  const bool isCopied =
      text != nullptr && copies.areAsked && !scene.bodyIndex.contains(*text) && scene.bodyIndex.contains(*text + "_0");
  if (!isCopied) {
    const std::optional<int> body = findNamed(name, scene.bodyIndex, "body", faults);
    if (body) checkChain(name, *body, copies, scene, faults);
    return body;
  }
  const int first = scene.bodyIndex.at(*text + "_0");
  const int count = scene.bodies[scene.draftOfBody[static_cast<std::size_t>(first)]].bodyCount;
  if (count == copies.total()) return first;
  addFault(
      faults, name,
      fmt::format("{} has {} copies, and what ties it {}; give both as many", inQuotes(*text), count, copies.total()));
  return std::nullopt;
}

// bodyA, anchorA, bodyB, anchorB
void parseEnds(ObjectReader& reader, const Vec3& usualAnchorB, const Copies& copies, const SceneDraft& scene,
               LinkDraft& draft) {
  const auto nameA = reader.require("bodyA"), nameB = reader.find("bodyB");
  const auto bodyA = nameA ? findEnd(*nameA, copies, scene, reader.faults()) : std::nullopt;
  const auto bodyB = nameB ? findEnd(*nameB, copies, scene, reader.faults()) : std::optional(kWorld);
  checkBodies(reader, bodyA, bodyB, scene.scene);
  draft.anchorA = parseAnchor(reader, "anchorA", bodyA.value_or(kWorld), Vec3::Zero(), scene);
  draft.anchorB = parseAnchor(reader, "anchorB", bodyB.value_or(kWorld), usualAnchorB, scene);
}

Spring parseSpring(ObjectReader& reader, LinkDraft& draft) {
  Spring spring;
  spring.stiffness = reader.number("stiffness", kStiffnesses, "N/m", 100);
  spring.damping = reader.number("damping", kDampings, "N s/m", 0);
  draft.length = reader.find("restLength");
  spring.restLength = reader.number("restLength", kLengthsOrZero, "m", 0);
  return spring;
}

Rod parseRod(ObjectReader& reader, LinkDraft& draft) {
  Rod rod;
  draft.length = reader.find("length");
  rod.length = reader.number("length", kLengths, "m", 1);
  return rod;
}

Rope parseRope(ObjectReader& reader, LinkDraft& draft) {
  Rope rope;
  draft.length = reader.find("maxLength");
  rope.maxLength = reader.number("maxLength", kLengths, "m", 1);
  rope.restitution = reader.number("restitution", kFraction, "", 0);
  return rope;
}

/// Limits of a hinge that are whole numbers of many radians are likely to be degrees.
void warnOfDegrees(const char* key, double limit, const Field& field, FaultList& faults) {
  if (std::abs(limit) < kLikelyDegrees || std::floor(limit) != limit) return;
  addWarning(faults, field,
             fmt::format("{} is {} rad, {:.3g} turns; {} degrees would be {:.6g} rad", key, limit,
                         limit / (360 * kRadiansPerDegree), limit, limit * kRadiansPerDegree));
}

/// The start must lie between the limits, where the coordinate is 0. `unit` is that of the bounds.
void checkRange(const JointRange& range, const std::optional<Field>& lower, const std::optional<Field>& upper,
                const char* unit, FaultList& faults) {
  const char* const why = "the coordinate is 0 at the start, which must lie between the limits";
  if (lower && range.lower > 0)
    addFault(faults, *lower, fmt::format("lower is {}; {}; allowed is 0 or less ({})", range.lower, why, unit));
  if (upper && range.upper < 0)
    addFault(faults, *upper, fmt::format("upper is {}; {}; allowed is 0 or more ({})", range.upper, why, unit));
}

JointRange parseRange(const Field& field, bool isHinge, FaultList& faults) {
  JointRange range;
  const char* const unit = isHinge ? "rad" : "m";
  const Range bounds = isHinge ? kTurns : kCoordinates;
  ObjectReader reader(field, faults);
  const auto lower = reader.find("lower"), upper = reader.find("upper");
  range.lower = reader.number("lower", bounds, unit, range.lower);
  range.upper = reader.number("upper", bounds, unit, range.upper);
  if (lower && upper && range.lower > range.upper)
    addFault(faults, field, fmt::format("lower is {} and upper is {}; exchange them", range.lower, range.upper));
  else
    checkRange(range, lower, upper, unit, faults);
  if (isHinge && lower) warnOfDegrees("lower", range.lower, *lower, faults);
  if (isHinge && upper) warnOfDegrees("upper", range.upper, *upper, faults);
  range.restitution = reader.number("restitution", kFraction, "", 0);
  if (!lower && !upper)
    reader.addMissing({"lower", "upper"},
                      "the limits have neither \"lower\" nor \"upper\"; give one or both, or leave limits out");
  reader.rejectUnknownKeys();
  if (!lower && !upper) return range;
  if (range.lower == range.upper)
    addFault(faults, field, "lower and upper are both 0, which leaves no motion; weld the bodies instead");
  return range;
}

/// The keys of a motor, by what it works on.
struct MotorKeys {
  const char *owner, *most, *constant, *velocityUnit, *forceUnit;
};
constexpr MotorKeys kHingeMotor{"hinge", "maxTorque", "torque", "rad/s", "N m"},
    kSliderMotor{"slider", "maxForce", "force", "m/s", "N"};

void refuseKeysOf(const MotorKeys& other, const MotorKeys& keys, ObjectReader& reader) {
  const auto refuse = [&](const char* found, const char* allowed) {
    reader.refuse(found, fmt::format("{} is for the motor of a {}; a {} has \"{}\" ({})", found, other.owner,
                                     keys.owner, allowed, keys.forceUnit));
  };
  refuse(other.most, keys.most);
  refuse(other.constant, keys.constant);
}

JointDrive parseMotor(const Field& field, const MotorKeys& keys, FaultList& faults) {
  JointDrive motor;
  const std::size_t faultsBefore = faults.count();
  ObjectReader reader(field, faults);
  const auto target = reader.find("targetVelocity"), most = reader.find(keys.most),
             constant = reader.find(keys.constant);
  if (target) motor.targetVelocity = reader.number("targetVelocity", kSpeeds, keys.velocityUnit, 0);
  if (most) motor.force = reader.number(keys.most, {0, kForces.most}, keys.forceUnit, 0);
  if (constant) motor.force = reader.number(keys.constant, kForces, keys.forceUnit, 0);
  refuseKeysOf(&keys == &kHingeMotor ? kSliderMotor : kHingeMotor, keys, reader);
  const bool isWhole = target.has_value() != constant.has_value() && target.has_value() == most.has_value();
  if (faults.count() == faultsBefore && !isWhole)
    reader.addMissing(
        {"targetVelocity", keys.most, keys.constant},
        fmt::format("found {} in the motor; allowed is either a \"targetVelocity\" with a \"{}\" or a "
                    "constant \"{}\"",
                    reader.keysFound({"targetVelocity", keys.most, keys.constant}), keys.most, keys.constant));
  reader.rejectUnknownKeys();
  if (faults.count() == faultsBefore && most && motor.force == 0)
    addWarning(faults, *most, fmt::format("{} is 0: the motor moves nothing", keys.most));
  return motor;
}

template <typename Joint>
Joint parseJoint(ObjectReader& reader, LinkDraft&) {
  Joint joint;
  if constexpr (requires { joint.axis; }) joint.axis = reader.direction("axis", joint.axis);
  if constexpr (requires { joint.limits; }) {
    constexpr bool isHinge = std::is_same_v<Joint, Hinge>;
    if (const auto field = reader.find("limits")) joint.limits = parseRange(*field, isHinge, reader.faults());
    if (const auto field = reader.find("motor"))
      joint.motor = parseMotor(*field, isHinge ? kHingeMotor : kSliderMotor, reader.faults());
  } else {
    for (const char* key : {"limits", "motor"})
      reader.refuse(key, fmt::format("{} is for hinges and sliders, which have one coordinate; leave it out, or take "
                                     "one of these",
                                     key));
  }
  const bool collide = reader.boolean("collide", false);
  if constexpr (requires { joint.collide; }) joint.collide = collide;  // there is no contact inside one body of welds
  return joint;
}

template <typename Link>
struct LinkSyntax {
  const char* key;   // of the array in the scene file
  const char* noun;  // names are noun0, noun1, ... by default
  Vec3 usualAnchorB;
  Link (*parse)(ObjectReader&, LinkDraft&);
};

using NamePlaces = std::map<std::string, std::string>;  // name of a link -> where it is

template <typename Link>
LinkDraft parseLink(const Field& field, const LinkSyntax<Link>& kind, std::size_t number, const SceneDraft& scene,
                    Copies& copies, FaultList& faults) {
  LinkDraft draft;
  draft.field = field;
  ObjectReader reader(field, faults);
  const std::string name = reader.name("name", fmt::format("{}{}", kind.noun, number));
  copies = parseCopies(reader);
  parseEnds(reader, kind.usualAnchorB, copies, scene, draft);
  Link link = kind.parse(reader, draft);
  reader.rejectUnknownKeys();
  link.name = name;
  link.where = faults.where(field.place(), field.pointer);
  draft.link = link;
  return draft;
}

// A link with faults, or of a body with faults, is not looked at further: what it seems to lack may follow from them.
bool isSound(const LinkDraft& link, const SceneDraft& scene) {
  for (const int body : {link.anchorA.anchor.body, link.anchorB.anchor.body}) {
    if (body != kWorld && !scene.bodies[scene.draftOfBody[static_cast<std::size_t>(body)]].isSound) return false;
  }
  return true;
}

/// Directions in which links hold each body. All rows of a body depend on each other: their matrix is full.
class HeldDirections {
 public:
  explicit HeldDirections(const SceneDraft& draft) : directions_(draft.scene.bodies.size(), 0) {}

  /// Once a body is held in too many, further links need not be read: they may be hundreds of thousands.
  bool isAnyTooMany() const { return isAnyTooMany_; }

  void add(const LinkDraft& link, const SceneDraft& draft, FaultList& faults) {
    for (const int body : {link.anchorA.anchor.body, link.anchorB.anchor.body}) {
      if (isFixed(body, draft.scene)) continue;
      int& sum = directions_[static_cast<std::size_t>(body)];
      sum += std::visit([](const auto& kind) { return kind.kDirections; }, link.link);
      if (sum <= kMaxDirections) continue;
      isAnyTooMany_ = true;
      addFault(faults, link.field,
               fmt::format("from here on, {} is held in more than {} directions; at most {} are allowed, where a rod "
                           "or a rope counts 1, a ball joint 3, a hinge 5, a slider 5 and a weld 6; leave out what "
                           "holds it twice",
                           inQuotes(draft.scene.bodies[static_cast<std::size_t>(body)].name), kMaxDirections,
                           kMaxDirections));
    }
  }

 private:
  std::vector<int> directions_;  // by body
  bool isAnyTooMany_ = false;
};

/// Takes an end to copy `number`: to a copy of its body, or, on what has no copies, moved along with them.
void moveEnd(const Copies& copies, int number, const SceneDraft& scene, AnchorDraft& end) {
  if (const std::optional<int> body = bodyOfCopy(end.anchor.body, copies, number, scene)) {
    end.anchor.body = *body;
    return;
  }
  const RigidTransform move = copies.move(number);
  const RigidTransform world = end.anchor.body == kWorld
                                   ? RigidTransform{}
                                   : scene.scene.bodies[static_cast<std::size_t>(end.anchor.body)].worldFromBody;
  end.anchor.point = world.inverse() * (move * (world * end.anchor.point));
}

/// Of a joint whose body A has no copies: its axis, in that body's frame, turns with them.
template <typename Link>
void turnAxis(const Copies& copies, int number, const SceneDraft& scene, const LinkDraft& first, Link& link) {
  if constexpr (requires { link.axis; }) {
    const int body = first.anchorA.anchor.body;
    if (body == kWorld || bodyOfCopy(body, copies, number, scene)) return;
    const Quat& worldFromBody = scene.scene.bodies[static_cast<std::size_t>(body)].worldFromBody.rotation;
    link.axis = worldFromBody.conjugate() * (copies.move(number).rotation * (worldFromBody * link.axis));
  }
}

/// Copy `number` of a link without faults.
template <typename Link>
LinkDraft copyOf(const LinkDraft& first, const Copies& copies, int number, const SceneDraft& scene) {
  LinkDraft draft = first;
  Link& link = std::get<Link>(draft.link);
  link.name += fmt::format("_{}", number);
  turnAxis(copies, number, scene, first, link);
  moveEnd(copies, number, scene, draft.anchorA);
  moveEnd(copies, number, scene, draft.anchorB);
  return draft;
}

/// A vertex has no place beside it that copies could move to; and copies that go nowhere tie the same twice.
void checkCopies(const LinkDraft& draft, const Copies& copies, const SceneDraft& scene, FaultList& faults) {
  if (!copies.areAsked) return;
  bool goesAlong = false;
  for (const AnchorDraft* end : {&draft.anchorA, &draft.anchorB}) {
    const bool isOnCopies = bodyOfCopy(end->anchor.body, copies, 0, scene).has_value();
    goesAlong = goesAlong || isOnCopies;
    if (end->isOfMesh() && !isOnCopies)
      addFault(faults, end->field, "a vertex of a body without copies cannot move along with them; give a point");
    if (end->pick) addFault(faults, end->field, "what a pixel shows has no copies; give a point");
  }
  if (!goesAlong && !copies.ring && copies.spacing.isZero(0) && copies.total() > 1)
    addFault(faults, draft.field,
             "all copies would be the same: neither end is on a body with copies, and the spacing is zero; tie copies, "
             "as \"ball\", or give a spacing");
  if (static_cast<double>(scene.links.size()) + copies.total() > kMaxBodies)
    addFault(faults, draft.field, fmt::format("the scene would have more than {} links", kMaxBodies));
}

template <typename Link>
void parseKind(ObjectReader& root, const LinkSyntax<Link>& kind, NamePlaces& names, HeldDirections& held,
               SceneDraft& scene) {
  FaultList& faults = root.faults();
  std::size_t number = 0;
  for (const Field& item : root.items(kind.key)) {
    if (held.isAnyTooMany()) return;
    const std::size_t faultsBefore = faults.count();
    Copies copies;
    LinkDraft draft = parseLink(item, kind, number++, scene, copies, faults);
    checkCopies(draft, copies, scene, faults);
    draft.isSound = faults.count() == faultsBefore && isSound(draft, scene);
    const Link& link = std::get<Link>(draft.link);
    const auto [first, isNew] = names.emplace(link.name, link.where);
    if (!isNew) {
      const auto name = ObjectReader(item, faults).find("name");
      addFault(faults, name.value_or(item),
               fmt::format("duplicate name {}; names of springs, rods, ropes and joints must differ; the first is {}",
                           inQuotes(link.name), first->second));
    }
    if (!copies.areAsked || !draft.isSound) {
      held.add(draft, scene, faults);
      scene.links.push_back(std::move(draft));
      continue;
    }
    for (int copy = 0; copy < copies.total() && !held.isAnyTooMany(); ++copy) {
      scene.links.push_back(copyOf<Link>(draft, copies, copy, scene));
      held.add(scene.links.back(), scene, faults);
      names.emplace(std::get<Link>(scene.links.back().link).name, link.where);
    }
  }
}

}  // namespace

void parseLinks(ObjectReader& root, SceneDraft& draft) {
  NamePlaces names;
  HeldDirections held(draft);
  const Vec3 above = Vec3::UnitY();
  parseKind<Spring>(root, {"springs", "spring", Vec3::Zero(), parseSpring}, names, held, draft);
  parseKind<Rod>(root, {"rods", "rod", above, parseRod}, names, held, draft);
  parseKind<Rope>(root, {"ropes", "rope", above, parseRope}, names, held, draft);
  parseKind<BallJoint>(root, {"ballJoints", "ballJoint", above, parseJoint<BallJoint>}, names, held, draft);
  parseKind<Hinge>(root, {"hinges", "hinge", above, parseJoint<Hinge>}, names, held, draft);
  parseKind<Slider>(root, {"sliders", "slider", above, parseJoint<Slider>}, names, held, draft);
  parseKind<Weld>(root, {"welds", "weld", above, parseJoint<Weld>}, names, held, draft);
}

}  // namespace cradle
