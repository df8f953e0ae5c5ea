// More rods and joints than degrees of freedom: rows that say the same twice share their load.

#include <gtest/gtest.h>

#include <numbers>

#include "experiments/tie_error.h"

namespace cradle {
namespace {

std::string rods(const std::vector<std::pair<Vec3, Vec3>>& ends, const std::string& name) {
  std::string text;
  for (const auto& [onBody, inWorld] : ends)
    text += fmt::format(R"({}{{"bodyA": "{}", "anchorA": {}, "anchorB": {}}})", text.empty() ? "" : ", ", name,
                        vectorText(onBody), vectorText(inWorld));
  return text;
}

/// A board's rods: a leg below each corner, and the diagonals along two of its sides and both of the others.
std::vector<std::pair<Vec3, Vec3>> tableLegs() {
  std::vector<std::pair<Vec3, Vec3>> ends;
  const std::vector<Vec3> corners = {{0.5, 0, 0.4}, {-0.5, 0, 0.4}, {-0.5, 0, -0.4}, {0.5, 0, -0.4}};
  const Vec3 down(0, -1, 0);
  for (std::size_t i = 0; i < 4; ++i) {
    ends.emplace_back(corners[i], corners[i] + down);
    ends.emplace_back(corners[i], corners[(i + 1) % 4] + down);
  }
  return ends;
}

// Eight rods hold six degrees of freedom. Weight and inertia off the middle load them unevenly.
TEST(TableOnEightRods, Stands) {
  const Scene scene = sceneWith(
      R"("duration": 5, "accuracy": 1e-10, "output": {"framesPerSecond": 2}, "bodies": [{"name": "board",
      "shape": {"box": {"size": [1, 0.05, 0.8]}}, "collision": "none", "mass": 20, "centerOfMass": [0.2, 0.03, -0.1],
      "inertiaTensor": [[1, 0.1, 0], [0.1, 2, 0.2], [0, 0.2, 1.5]]}], "rods": [)" +
      rods(tableLegs(), "board") + "]");
  const Trajectory run = simulate(scene);
  for (const Frame& frame : run.frames) {
    EXPECT_LT((frame.states[0].position - Vec3(0.2, 0.03, -0.1)).norm(), 1e-12);
    EXPECT_LT(frame.states[0].linearVelocity.norm() + frame.states[0].angularVelocity.norm(), 1e-12);
  }
  EXPECT_LT(largestTieError(run, scene), 1e-12);
}

// A board on four parallel rods of one length swings without turning, each point on a circle of that length: a simple
// pendulum. Three rods say it all; the fourth is one too many, in every place.
TEST(BoardOnFourParallelRods, SwingsLikeASimplePendulum) {
  const double length = 0.8, angle = 0.7, frequency = std::sqrt(9.81 / length);
  const double period = 4 * std::comp_ellint_1(std::sin(angle / 2)) / frequency;
  const Vec3 up = length * Vec3(std::sin(angle), std::cos(angle), 0);
  std::vector<std::pair<Vec3, Vec3>> ends;
  for (const Vec3& corner : {Vec3(0.5, 0, 0.4), Vec3(-0.5, 0, 0.4), Vec3(-0.5, 0, -0.4), Vec3(0.5, 0, -0.4)})
    ends.emplace_back(corner, corner + up);
  const Scene scene = sceneWith(fmt::format(
      R"("duration": {}, "accuracy": 1e-10, "output": {{"framesPerSecond": {}}}, "bodies": [{{"name": "board",
      "shape": {{"box": {{"size": [1, 0.05, 0.8]}}}}, "collision": "none", "mass": 20, "centerOfMass": [0.2, 0.03, -0.1],
      "inertiaTensor": [[1, 0.1, 0], [0.1, 2, 0.2], [0, 0.2, 1.5]]}}], "rods": [{}])",
      2 * period, 4 / period, rods(ends, "board")));
  const Trajectory run = simulate(scene);
  ASSERT_EQ(run.frames.size(), 9u);
  const Vec3 center(0.2, 0.03, -0.1), pivot = center + up;
  const double angles[] = {-angle, 0, angle, 0};
  for (const Frame& frame : run.frames) {
    const double at = angles[frame.number % 4];
    EXPECT_LT((frame.states[0].position - pivot - length * Vec3(std::sin(at), -std::cos(at), 0)).norm(), 1e-8)
        << frame.number;
    EXPECT_LT(orientationError(frame.states[0].orientation, Quat::Identity()), 1e-9);
  }
  EXPECT_LT(largestTieError(run, scene), 1e-10);
}

std::string doublePendulum(const std::string& moreRods) {
  const std::string bob = R"("shape": {"sphere": {"radius": 0.01}}, "collision": "none", "mass": 1)";
  return R"("duration": 2, "accuracy": 1e-10, "output": {"framesPerSecond": 5}, "bodies": [
      {"name": "upper", "position": [1, 0, 0], )" +
         bob + R"(}, {"name": "lower", "position": [2, 0, 0], )" + bob +
         R"(}], "rods": [{"bodyA": "upper", "anchorA": [0, 0, 0], "anchorB": [0, 0, 0]},
      {"bodyA": "lower", "anchorA": [0, 0, 0], "bodyB": "upper", "anchorB": [0, 0, 0]})" +
         moreRods + "]";
}

TEST(TwoRodsInPlaceOfOne, ChangeNothing) {
  const Trajectory one = simulate(sceneWith(doublePendulum("")));
  const Trajectory two = simulate(sceneWith(
      doublePendulum(R"(, {"bodyA": "upper", "anchorA": [0, 0, 0], "bodyB": "lower", "anchorB": [0, 0, 0]})")));
  for (std::size_t i = 0; i < one.frames.size(); ++i)
    for (const std::size_t body : {0u, 1u})
      EXPECT_LT((one.frames[i].states[body].position - two.frames[i].states[body].position).norm(), 1e-9) << i;
}

/// Six links of 1 m in a closed chain, the first one fixed, along six edges of a cube; the hinges' axes are along edges
/// too, and each is perpendicular to its neighbours (R. Bricard's trihedral linkage, 1927; it is benchmark A04 of the
/// IFToMM's library of multibody problems). By counting, five links and six hinges have no freedom; it has one.
class BricardLinkage {
 public:
  static constexpr int kLinks = 6;

  static std::string members(const std::string& settings) {
    std::string bodies, hinges;
    for (int i = 1; i < kLinks; ++i) {
      const Vec3 middle = 0.5 * (corner(i) + corner(i + 1));
      bodies += fmt::format(R"({}{{"name": "link{}", "shape": {{"box": {{"size": {}}}}}, "collision": "none", "mass": 1,
        "position": {}}})",
                            i > 1 ? ", " : "", i, vectorText(Vec3::Constant(0.1) + 0.9 * direction(i).cwiseAbs()),
                            vectorText(middle));
    }
    for (int i = 1; i <= kLinks; ++i) hinges += (i > 1 ? ", " : "") + hinge(i);
    return fmt::format(R"({}, "bodies": [{}], "hinges": [{}])", settings, bodies, hinges);
  }

  /// Cosine of the angle between links `i` and i + 1, counted round.
  static double cosine(const Frame& frame, int i) {
    return directionIn(frame, i).dot(directionIn(frame, (i + 1) % kLinks));
  }

 private:
  static Vec3 direction(int link) { return Vec3::Unit(link % 3) * (link % kLinks < 3 ? 1 : -1); }
  static Vec3 corner(int link) {  // where a link begins
    Vec3 place = Vec3::Zero();
    for (int i = 0; i < link; ++i) place += direction(i);
    return place;
  }
  static Vec3 directionIn(const Frame& frame, int link) {
    if (link == 0) return direction(0);
    return frame.states[static_cast<std::size_t>(link - 1)].orientation * direction(link);
  }
  /// Between link i - 1 and link i.
  static std::string hinge(int i) {
    const auto centerOf = [](int link) { return Vec3(corner(link) + 0.5 * direction(link)); };
    const Vec3 axis = Vec3::Unit((i + 1) % 3);
    const int a = i < kLinks ? i : i - 1;
    const Vec3 anchorB = i == 1 || i == kLinks ? corner(i) : Vec3(corner(i) - centerOf(i - 1));
    const std::string bodyB = i == 1 || i == kLinks ? "" : fmt::format(R"("bodyB": "link{}", )", i - 1);
    return fmt::format(R"({{"bodyA": "link{}", "anchorA": {}, {}"anchorB": {}, "axis": {}}})", a,
                       vectorText(corner(i) - centerOf(a)), bodyB, vectorText(anchorB), vectorText(axis));
  }
};

// Cosines of neighbouring angles, c and d, repeat themselves round the chain, with c d + c + d = 0 (Y. Chen, Z. You,
// T. Tarnai, "Threefold-symmetric Bricard linkages for deployable structures", Int. J. Solids and Structures 42, 2005,
// for perpendicular axes): stretched out (c = 1) it is a flat triangle of side 2 m, d = -1/2.
TEST(BricardsLinkage, MovesWithOneFreedomAndKeepsEnergyAndClosure) {
  const Scene scene =
      sceneWith(BricardLinkage::members(R"("duration": 10, "accuracy": 1e-10, "output": {"framesPerSecond": 20})"));
  const Trajectory run = simulate(scene);
  double most = 0;
  for (const Frame& frame : run.frames) {
    const double c = BricardLinkage::cosine(frame, 0), d = BricardLinkage::cosine(frame, 1);
    EXPECT_NEAR(c * d + c + d, 0, 1e-8) << frame.time;
    for (const int i : {2, 4}) {
      EXPECT_NEAR(BricardLinkage::cosine(frame, i), c, 1e-8) << frame.time;
      EXPECT_NEAR(BricardLinkage::cosine(frame, i + 1), d, 1e-8) << frame.time;
    }
    most = std::max(most, std::abs(c));
  }
  EXPECT_GT(most, 0.3) << "did not move";
  EXPECT_LT(largestTieError(run, scene), 1e-9);
  double kinetic = 0;
  for (const Frame& frame : run.frames) kinetic = std::max(kinetic, frame.energy.kinetic);
  EXPECT_LT(largestEnergyError(run), 1e-7 * kinetic);
}

}  // namespace
}  // namespace cradle
