#include "simulate/pinned_contacts.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "simulate/one_island.h"

namespace cradle {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kTurnRounding = 1e-12;  // of unit vectors and places below 1 m, of JSON's orientations

const std::string kPinnedFloor = R"({"name": "ground", "shape": {"plane": {}}, "motion": "static"})";
/// Its edge along x is at the origin, its top at y = 0.
const std::string kPinnedEdge =
    R"({"name": "ground", "shape": {"box": {"size": [2, 1, 1]}}, "position": [0.1, -0.5, -0.5], "motion": "static"})";

/// A body with the point `touching` (m, its frame) at the origin, where a joint holds it to the world.
struct PinnedAtOrigin {
  std::string ground, shape;
  Vec3 touching;
  Quat turn = Quat::Identity();
  std::string joint = R"("ballJoints": [{"name": "pin", "bodyA": "b", "anchorA": {}, "anchorB": [0, 0, 0]}])";

  Assembly assembly() const {
    std::string link = joint;
    link.replace(link.find("{}"), 2, vectorText(touching));
    const Scene scene = sceneWith(fmt::format(
        R"("duration": 1, "bodies": [{}, {{"name": "b", "shape": {}, "position": {}, "orientation": {{"w": {}, "x": {},
        "y": {}, "z": {}}}}}], {})",
        ground, shape, vectorText(-(turn * touching)), turn.w(), turn.x(), turn.y(), turn.z(), link));
    return assemble(scene, wholeScene(scene));
  }
};

const std::string kPinSphere = R"({"sphere": {"radius": 0.1}})", kPinBox = R"({"box": {"size": [0.4, 0.2, 0.6]}})",
                  kPinCylinder = R"({"cylinder": {"radius": 0.1, "length": 0.3}})",
                  kPinCapsule = R"({"capsule": {"radius": 0.1, "length": 0.3}})";

/// Turns by which a hinge constraint moves at first order, to tell what it forbids: rates of axis . across.
double rateOfTurn(const Constraint& constraint, const Assembly& assembly, const Vec3& rotation, std::size_t row) {
  const HingeConstraint& hinge = std::get<HingeConstraint>(constraint.kind);
  const Vec3 axis = orientation(assembly.state, constraint.anchorA.body) * hinge.axisA;
  return rotation.cross(axis).dot(hinge.acrossB[row]);
}

/// The constraints of one kind.
template <class Kind>
std::vector<Constraint> constraintsOf(const Assembly& assembly) {
  std::vector<Constraint> found;
  for (const Constraint& constraint : assembly.mechanism.constraints)
    if (std::holds_alternative<Kind>(constraint.kind)) found.push_back(constraint);
  return found;
}
std::vector<Constraint> hingesOf(const Assembly& assembly) {
  return constraintsOf<HingeConstraint>(assembly);
}
std::vector<Constraint> ballJointsOf(const Assembly& assembly) {
  return constraintsOf<BallJointConstraint>(assembly);
}

/// Whether the constraints that are left allow a rotation (rad/s, world) about the anchor.
bool mayTurn(const Assembly& assembly, const Vec3& rotation) {
  for (const Constraint& hinge : hingesOf(assembly))
    for (const std::size_t row : {0u, 1u})
      if (std::abs(rateOfTurn(hinge, assembly, rotation, row)) > 1e-6) return false;
  return true;
}

const Quat kPinTurn(Eigen::AngleAxisd(0.7, Vec3(0.6, 0, 0.8)));

// A round end keeps the normal: it turns about that alone, and its ball joint is part of the new constraint.
TEST(PinnedContacts, KeepTheNormalOfARoundEnd) {
  const Vec3 down = kPinTurn.conjugate() * -Vec3::UnitY();
  for (const PinnedAtOrigin& pinned :
       {PinnedAtOrigin{kPinnedFloor, kPinSphere, 0.1 * down, kPinTurn},
        PinnedAtOrigin{kPinnedFloor, kPinCapsule, Vec3(0, -0.15, 0) + 0.1 * down, kPinTurn}}) {
    const Assembly at = pinned.assembly();
    EXPECT_THAT(at.names.constraints, ElementsAre("ball joint \"pin\""));
    ASSERT_THAT(at.mechanism.constraints, SizeIs(1));
    const auto& [anchorA, anchorB, kind] = at.mechanism.constraints[0];
    EXPECT_EQ(anchorA.body, 0);
    EXPECT_EQ(anchorB.body, kFixed);
    EXPECT_LT((anchorA.point - pinned.touching).norm(), kTurnRounding);
    EXPECT_LT(anchorB.point.norm(), kTurnRounding);
    ASSERT_TRUE(std::holds_alternative<HingeConstraint>(kind));
    EXPECT_LT((kPinTurn * std::get<HingeConstraint>(kind).axisA - Vec3::UnitY()).norm(), kTurnRounding);
    EXPECT_TRUE(mayTurn(at, Vec3::UnitY()));
    for (int i = 0; i < 6; ++i) EXPECT_FALSE(mayTurn(at, Vec3(std::cos(0.5 * i), 0.3, std::sin(0.5 * i))));
  }
}

// The side of a cylinder, or of a capsule, lies in the floor with a line: tilts to either end overlap, and rolling does
// as well. A rim rolls about its tangent t alone, and turns about the normal.
TEST(PinnedContacts, KeepTheTangentOfARimAcrossTheNormal) {
  const Quat tilt(Eigen::AngleAxisd(0.4, Vec3::UnitX()));  // the rim's lowest point is at -z, or +z
  const Assembly at = PinnedAtOrigin{kPinnedFloor, kPinCylinder, Vec3(0, -0.15, 0.1), tilt}.assembly();
  ASSERT_THAT(hingesOf(at), SizeIs(1));
  EXPECT_TRUE(mayTurn(at, Vec3::UnitX()));
  EXPECT_TRUE(mayTurn(at, Vec3::UnitY()));
  EXPECT_FALSE(mayTurn(at, Vec3::UnitZ()));
  // The tangent is the body's: after a quarter turn about the normal the body rolls about z, and not about x.
  Assembly turned = at;
  setOrientation(turned.state, 0, Quat(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitY())) * tilt);
  EXPECT_TRUE(mayTurn(turned, Vec3::UnitZ()));
  EXPECT_FALSE(mayTurn(turned, Vec3::UnitX()));
}

// Round side down, pinned in the middle of its line: every tilt of the normal sinks in, but that about the line's end.
TEST(PinnedContacts, KeepTheNormalOfALineOnAFace) {
  const Quat lying(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()));  // the axis y of the body along -x
  for (const std::string& shape : {kPinCylinder, kPinCapsule}) {
    const Assembly at = PinnedAtOrigin{kPinnedFloor, shape, lying.conjugate() * Vec3(0, -0.1, 0), lying}.assembly();
    ASSERT_THAT(hingesOf(at), SizeIs(1)) << shape;
    EXPECT_TRUE(mayTurn(at, Vec3::UnitY()));
    EXPECT_FALSE(mayTurn(at, Vec3::UnitX()));
    EXPECT_FALSE(mayTurn(at, Vec3::UnitZ()));
  }
}

// Corners can tip to all sides, and faces on faces have corners that tell.
TEST(PinnedContacts, LeaveCornersAndFacesToTheirContacts) {
  const Quat tipped = Quat::FromTwoVectors(Vec3(0.2, 0.1, 0.3).normalized(), Vec3::UnitY());
  for (const PinnedAtOrigin& pinned : {PinnedAtOrigin{kPinnedFloor, kPinBox, Vec3(-0.2, -0.1, -0.3), tipped},
                                       PinnedAtOrigin{kPinnedFloor, kPinBox, Vec3(0.05, -0.1, 0.1)}}) {
    const Assembly at = pinned.assembly();
    EXPECT_THAT(hingesOf(at), IsEmpty());
    EXPECT_THAT(ballJointsOf(at), SizeIs(1));
    EXPECT_THAT(at.names.constraints, ElementsAre("ball joint \"pin\""));
    EXPECT_THAT(at.geometry.colliders.at(0).pins, SizeIs(1));
  }
}

// On a ball as well: whatever is round about the point, a corner bends away from it to all sides, and an edge to two.
TEST(PinnedContacts, LeaveACornerOnABallAllItsTurns) {
  const std::string ball = R"({"name": "ground", "shape": {"sphere": {"radius": 0.5}}, "motion": "static",
      "position": [0, -0.5, 0]})";
  const Quat tipped = Quat::FromTwoVectors(Vec3(0.2, 0.1, 0.3).normalized(), Vec3::UnitY());
  const Assembly corner = PinnedAtOrigin{ball, kPinBox, Vec3(-0.2, -0.1, -0.3), tipped}.assembly();
  EXPECT_THAT(hingesOf(corner), IsEmpty());
  EXPECT_THAT(ballJointsOf(corner), SizeIs(1));
  const Quat onEdge(Eigen::AngleAxisd(-0.7, Vec3::UnitX()));
  const Assembly edge = PinnedAtOrigin{ball, kPinBox, Vec3(0.05, -0.1, -0.3), onEdge}.assembly();
  EXPECT_TRUE(mayTurn(edge, Vec3::UnitX()));
  EXPECT_FALSE(mayTurn(edge, Vec3::UnitZ()));
}

// On an edge along x a ball rolls about it, but not along it: the normal stays across x.
TEST(PinnedContacts, KeepANormalAcrossAnEdge) {
  const Vec3 normal(0, std::cos(0.6), std::sin(0.6));
  const Assembly at =
      PinnedAtOrigin{kPinnedEdge, kPinSphere, kPinTurn.conjugate() * (-0.1 * normal), kPinTurn}.assembly();
  ASSERT_THAT(hingesOf(at), SizeIs(1));
  EXPECT_TRUE(mayTurn(at, Vec3::UnitX()));
  EXPECT_TRUE(mayTurn(at, normal));
  EXPECT_FALSE(mayTurn(at, Vec3::UnitX().cross(normal)));
}

// A nanometre of the size off is apart: nothing is forbidden. Half of that is touching.
TEST(PinnedContacts, ForbidNothingOfWhatIsApart) {
  for (const double part : {0.5, 2.0}) {
    const std::string ground =
        fmt::format(R"({{"name": "ground", "shape": {{"plane": {{}}}}, "motion": "static", "position": [0, {}, 0]}})",
                    -part * 1e-10);
    const Assembly at = PinnedAtOrigin{ground, kPinSphere, Vec3(0, -0.1, 0)}.assembly();
    EXPECT_THAT(hingesOf(at), SizeIs(part < 1 ? 1 : 0));
    EXPECT_THAT(ballJointsOf(at), SizeIs(part < 1 ? 0 : 1));
  }
}

// A hinge about the normal keeps it by itself. One about another axis gets a second constraint.
TEST(PinnedContacts, AddToAHingeWhatItDoesNotKeep) {
  for (const bool isNormal : {true, false}) {
    const std::string joint =
        fmt::format(R"("hinges": [{{"name": "pin", "bodyA": "b", "anchorA": {{}}, "anchorB": [0, 0, 0], "axis": {}}}])",
                    isNormal ? "[0, 1, 0]" : "[1, 0, 0]");
    const Assembly at = PinnedAtOrigin{kPinnedFloor, kPinSphere, Vec3(0, -0.1, 0), Quat::Identity(), joint}.assembly();
    EXPECT_THAT(hingesOf(at), SizeIs(isNormal ? 1 : 2));
    EXPECT_EQ(mayTurn(at, Vec3::UnitY()), isNormal);
    EXPECT_FALSE(mayTurn(at, Vec3::UnitX()));
  }
}

// A joint with another moving body tells both colliders of its anchor, and forbids nothing.
TEST(PinnedContacts, TellBothCollidersOfAnAnchorBetweenMovingBodies) {
  const Scene scene = sceneWith(R"("duration": 1, "bodies": [
      {"name": "floor", "shape": {"plane": {}}, "motion": "static", "position": [0, -1, 0]}, {"name": "a", "shape": {"sphere": {"radius": 0.1}}}, {"name": "b", "shape": {"sphere": {"radius": 0.2}},
       "position": [0.3, 0, 0]}],
      "ballJoints": [{"bodyA": "a", "anchorA": [0.1, 0, 0], "bodyB": "b", "anchorB": [-0.2, 0, 0]}])");
  const Assembly at = assemble(scene, wholeScene(scene));
  EXPECT_THAT(hingesOf(at), IsEmpty());
  EXPECT_THAT(ballJointsOf(at), SizeIs(1));
  ASSERT_THAT(at.geometry.colliders, SizeIs(2));
  for (const std::size_t body : {0u, 1u}) {
    ASSERT_THAT(at.geometry.colliders[body].pins, SizeIs(1));
    EXPECT_EQ(at.geometry.colliders[body].pins[0].other, body == 0 ? 1 : 0);
    EXPECT_LT((at.geometry.colliders[body].pins[0].point - Vec3(body == 0 ? 0.1 : -0.2, 0, 0)).norm(), 1e-15);
  }
}

}  // namespace
}  // namespace cradle
