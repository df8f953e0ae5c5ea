#include <gtest/gtest.h>

#include <array>

#include "experiments/ridged_ground.h"

// Meshes that are not closed: sheets of thickness zero, obstacles from both sides for bodies of all shapes.

namespace cradle {
namespace {

constexpr double kBodyHalfHeight = 0.1;  // m, of each of the shapes

/// A shape, and the points that are lowestOver in some position of it, with a ball of that radius around each.
struct SheetBody {
  std::string shape;
  std::vector<Vec3> points;  // m, in the body's frame
  double radius = 0;
};

std::vector<Vec3> boxCorners(const Vec3& half) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(half.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  return corners;
}

std::vector<Vec3> rimPoints(double radius) {
  std::vector<Vec3> points;
  for (int i = 0; i < 64; ++i)
    for (const double y : {-kBodyHalfHeight, kBodyHalfHeight})
      points.emplace_back(radius * std::cos(0.1 * i), y, radius * std::sin(0.1 * i));
  return points;
}

const std::vector<SheetBody> kSheetBodies = {
    {R"({"sphere": {"radius": 0.1}})", {Vec3::Zero()}, 0.1},
    {R"({"box": {"size": [0.3, 0.2, 0.25]}})", boxCorners({0.15, kBodyHalfHeight, 0.125})},
    {R"({"capsule": {"radius": 0.06, "length": 0.08}})", {Vec3(0, 0.04, 0), Vec3(0, -0.04, 0)}, 0.06},
    {R"({"cylinder": {"radius": 0.12, "length": 0.2}})", rimPoints(0.12)},
    {R"({"mesh": "wedge.obj"})", {}},
    {R"({"mesh": "angle.obj"})", {}}};

/// What is between a polygon and itself shifted along z.
LoadedModel extruded(const Profile& outline, const std::vector<Triangle>& front, double depth) {
  DrawnMesh mesh;
  const auto count = static_cast<std::uint32_t>(outline.size());
  for (const double z : {-depth / 2, depth / 2})
    for (const auto& [x, y] : outline) mesh.vertices.emplace_back(x, y, z);
  for (std::uint32_t i = 0; i < count; ++i) addQuad(mesh, i, (i + 1) % count, count + (i + 1) % count, count + i);
  for (const auto& [a, b, c] : front)
    mesh.triangles.insert(mesh.triangles.end(), {{count + a, count + b, count + c}, {a, c, b}});
  return modelOf(mesh);
}

/// A hull, and a mesh with a hollow, whose centres of mass are 0.1 m over their feet.
LoadedModel sheetBodyModel(const std::string& path) {
  if (path.find("wedge") != std::string::npos)
    return extruded({{-0.15, -0.1}, {0.15, -0.1}, {0, 0.2}}, {{0, 1, 2}}, 0.2);
  return extruded({{-0.2, -0.1}, {0.2, -0.1}, {0.2, 0.3}, {0.1, 0.3}, {0.1, 0}, {-0.2, 0}},
                  {{0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}}, 0.2);
}

std::vector<Vec3> sheetBodyPoints(const SheetBody& thing) {
  if (!thing.points.empty()) return thing.points;
  return sheetBodyModel(thing.shape).model.solid.vertices;
}

/// Up is y from above, and -y from below.
std::string sheetBodyText(const SheetBody& thing, const Vec3& position, const std::string& more) {
  return fmt::format(R"({{"name": "b", "shape": {}, "material": "m", "position": {}{}}})", thing.shape,
                     vectorText(position), more);
}

Scene sceneOverSheet(const LoadedModel& ground, double accuracy, double duration, const std::string& more,
                     const std::string& bodies) {
  const std::string text = fmt::format(
      R"({{"schema": "cradle-scene/1", "name": "Sheet", "duration": {}, "accuracy": {}, "output": {{"framesPerSecond": 120}},
    "bodies": [{{"name": "sheet", "shape": {{"mesh": "sheet.obj"}}, "motion": "static", "material": "m"}}, {}], {}}})",
      duration, accuracy, bodies, more);
  return parseScene(text, "sheet.json",
                    [&](const MeshReference& reference) {
                      return reference.path.find("sheet") != std::string::npos ? ground
                                                                               : sheetBodyModel(reference.path);
                    })
      .scene;
}

std::string sheetMaterial(double restitution, double friction) {
  return fmt::format(R"("materials": {{"m": {{"restitution": {}, "staticFriction": {}, "dynamicFriction": {}}}}})",
                     restitution, friction, friction);
}

/// m: of the lowestOver point over a height that is given for a place, times the side.
template <class Height>
double lowestOver(const SheetBody& thing, const BodyState& state, const Vec3& centerOfMass, double side,
                  const Height& height) {
  double least = INFINITY;
  for (const Vec3& point : sheetBodyPoints(thing)) {
    const Vec3 place = state.position + state.orientation * (point - centerOfMass);
    least = std::min(least, side * (place.y() - height(place)) - thing.radius);
  }
  return least;
}

Vec3 sheetBodyCenter(const Scene& scene) {
  return scene.bodies.back().massProperties.centerOfMass;
}

/// A grid of hills 0.1 m high, 0.8 m from one to the next.
double hillHeight(double x, double z) {
  return 0.05 * (std::sin(7.854 * x) + std::cos(7.854 * z));
}

constexpr double kHillCell = 0.1, kHillStart = -2;  // m
constexpr int kHillCells = 40;

LoadedModel hillSheet() {
  DrawnMesh mesh;
  for (int i = 0; i <= kHillCells; ++i)
    for (int k = 0; k <= kHillCells; ++k) {
      const double x = kHillStart + kHillCell * i, z = kHillStart + kHillCell * k;
      mesh.vertices.emplace_back(x, hillHeight(x, z), z);
    }
  const auto at = [](int i, int k) { return static_cast<std::uint32_t>(i * (kHillCells + 1) + k); };
  for (int i = 0; i < kHillCells; ++i)
    for (int k = 0; k < kHillCells; ++k) addQuad(mesh, at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k));
  return modelOf(mesh);
}

/// Of the facets of the hills: each cell is cut from its lower to its upper corner.
double facetHeight(const Vec3& place) {
  const double x = (place.x() - kHillStart) / kHillCell, z = (place.z() - kHillStart) / kHillCell;
  const double i = std::floor(x), k = std::floor(z), u = x - i, w = z - k;
  const auto at = [&](double di, double dk) {
    return hillHeight(kHillStart + kHillCell * (i + di), kHillStart + kHillCell * (k + dk));
  };
  return u > w ? at(0, 0) + u * (at(1, 0) - at(0, 0)) + w * (at(1, 1) - at(1, 0))
               : at(0, 0) + w * (at(0, 1) - at(0, 0)) + u * (at(1, 1) - at(0, 1));
}

const Profile kLevelGround = {{-3, 0}, {-0.35, 0}, {0.4, 0}, {3, 0}};

// From above, and with gravity upwards from below, whichever way the triangles are wound.
TEST(LevelSheet, CarriesEveryShapeAtItsHalfHeightOnEitherSide) {
  for (const SheetBody& thing : kSheetBodies)
    for (const double side : {1, -1})
      for (const double accuracy : {1e-3, 1e-6}) {
        const std::string turn = side < 0 ? R"(, "orientation": {"axis": [0, 0, 1], "angleDegrees": 180})" : "";
        const Scene scene =
            sceneOverSheet(ridgedGround(kLevelGround, true), accuracy, 1,
                           sheetMaterial(0, 0.5) + fmt::format(R"(, "gravity": [0, {}, 0])", -side * kGravity),
                           sheetBodyText(thing, Vec3(0.02, side * (kBodyHalfHeight + 0.05), 0.1), turn));
        const Trajectory run = simulate(scene);
        const BodyState& end = run.frames.back().states[0];
        const double over = lowestOver(thing, end, sheetBodyCenter(scene), side, [](const Vec3&) { return 0.0; });
        EXPECT_NEAR(over, 0, 1e-7) << thing.shape << " on side " << side << " at " << accuracy;
        EXPECT_LT(end.linearVelocity.norm() + end.angularVelocity.norm(), 1e-9) << thing.shape;
      }
}

// Closed form: thrown upwards under a sheet, without gravity, and back at the same speed.
TEST(LevelSheet, ThrowsBallsBackFromBothSides) {
  for (const double side : {1, -1}) {
    const Scene scene =
        sceneOverSheet(ridgedGround(kLevelGround, true), 1e-8, 1, sheetMaterial(1, 0) + R"(, "gravity": [0, 0, 0])",
                       sheetBodyText(kSheetBodies[0], Vec3(0.1, side * 0.6, 0.05),
                                     fmt::format(R"(, "linearVelocity": [0, {}, 0])", -side)));
    for (const Frame& frame : simulate(scene).frames)
      ASSERT_NEAR(frame.states[0].position.y(), side * (0.1 + std::abs(0.5 - frame.time)), 1e-9) << frame.time;
  }
}

// Hundreds of times its thickness in a step of 1/960 s, spinning, on a slant, near a crease, with all methods.
TEST(Sheet, IsNotPassedThroughAtAnySpeed) {
  for (const Profile& profile :
       {kLevelGround, Profile{{-3, -0.3}, {0, 0}, {3, -0.3}}, Profile{{-3, 0.3}, {0, 0}, {3, 0.3}}})
    for (const SheetBody& thing : kSheetBodies)
      for (const double side : {1, -1})
        for (const double speed : {3, 300})
          for (const double accuracy : {1e-3, 1e-6}) {
            const Scene scene = sceneOverSheet(
                ridgedGround(profile, true), accuracy, std::min(0.2, 2 / speed),
                sheetMaterial(0.2, 0.3) + R"(, "gravity": [0, 0, 0])",
                sheetBodyText(thing, Vec3(0.01, side * 0.6, 0),
                              fmt::format(R"(, "linearVelocity": [{}, {}, 0], "angularVelocity": [3, 1, -7])",
                                          0.3 * speed, -side * speed)));
            for (const Frame& frame : simulate(scene).frames) {
              const double over =
                  lowestOver(thing, frame.states[0], sheetBodyCenter(scene), side,
                             [&](const Vec3& place) { return std::abs(place.x()) / 3 * profile[0].second; });
              ASSERT_GT(over, -0.005) << thing.shape << " side " << side << " speed " << speed << " " << accuracy
                                      << " at " << frame.time;
            }
          }
}

TEST(Hills, CarryEveryShapeAndTakeTheirEnergy) {
  for (const SheetBody& thing : kSheetBodies)
    for (const double accuracy : {1e-3}) {
      const Scene scene = sceneOverSheet(hillSheet(), accuracy, 0.6, sheetMaterial(0.2, 0.6),
                                         sheetBodyText(thing, Vec3(0.13, 0.45, -0.21),
                                                       R"(, "orientation": {"axis": [1, 2, 3], "angleDegrees": 70},
                                                 "linearVelocity": [0.3, 0, 0.2])"));
      const Trajectory run = simulate(scene);
      double energy = INFINITY;
      for (const Frame& frame : run.frames) {
        ASSERT_GT(lowestOver(thing, frame.states[0], sheetBodyCenter(scene), 1, facetHeight), -0.002)
            << thing.shape << " " << accuracy << " at " << frame.time;
        ASSERT_LT(mechanicalEnergy(frame), energy + 0.01 * std::abs(mechanicalEnergy(run.frames[0]))) << frame.time;
        energy = std::min(energy, mechanicalEnergy(frame));
      }
    }
}

// Inside of an open cone, and on its outside.
TEST(Lampshade, HoldsABallInsideAndTurnsOneAwayOutside) {
  const LoadedModel shade = facetedBowl(12, 4, true);
  for (const double accuracy : {1e-3, 1e-6}) {
    const Scene inside = sceneOverSheet(shade, accuracy, 1.5, sheetMaterial(0, 0.1),
                                        sheetBodyText(kSheetBodies[0], Vec3(0.3, -0.5, 0.1), ""));
    for (const Frame& frame : simulate(inside).frames)
      ASSERT_LT(frame.states[0].position.norm(), 0.9 + 1e-3) << frame.time;
    const Scene outside =
        sceneOverSheet(shade, accuracy, 1, sheetMaterial(0.5, 0.1) + R"(, "gravity": [0, 0, 0])",
                       sheetBodyText(kSheetBodies[0], Vec3(0.3, -2, 0.1), R"(, "linearVelocity": [0, 3, 0])"));
    for (const Frame& frame : simulate(outside).frames) ASSERT_GT(frame.states[0].position.norm(), 1) << frame.time;
  }
}

TEST(Sheet, IsRefusedWhereABodyIsOnBothOfItsSides) {
  for (const SheetBody& thing : kSheetBodies) {
    const Scene scene = sceneOverSheet(ridgedGround(kLevelGround, true), 1e-6, 1, sheetMaterial(0, 0),
                                       sheetBodyText(thing, Vec3(0, 0.01, 0), ""));
    try {
      simulate(scene);
      FAIL() << thing.shape;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::scene);
      EXPECT_NE(std::string(error.what()).find("move it by"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace cradle
