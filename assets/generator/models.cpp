#include "models.h"

#include <cmath>
#include <numbers>

#include "die.h"
#include "rocks.h"
#include "t_handle.h"

namespace cradle::assets {
namespace {

using std::numbers::pi;

// Newton's cradle: five balls of radius 0.025 m hang between two rails from legs on a board.
namespace frame {
constexpr double kRailHeight = 0.32;    // m, axis of a rail above the ground
constexpr double kRailDistance = 0.16;  // m, between the axes: z = -0.08 and z = 0.08
constexpr double kRailLength = 0.36;    // m, between the axes of its legs
constexpr double kBendRadius = 0.03;    // m, of the axis where a rail becomes a leg
constexpr double kTubeRadius = 0.005;   // m
constexpr double kFootRadius = 0.012;   // m, where a leg stands on the board
constexpr double kFootHeight = 0.008;   // m
constexpr double kBoardThickness = 0.02, kBoardLength = 0.44, kBoardWidth = 0.24, kBoardBevel = 0.004;  // m
}  // namespace frame

double fraction(std::size_t i, std::size_t count) {
  return static_cast<double>(i) / static_cast<double>(count);
}

Vec3 aroundY(double angle) {
  return {std::cos(angle), 0, -std::sin(angle)};
}

// A sphere of radius 1: the faces of an octahedron in `kRows` rows, blown up. Its six tips lie on the axes exactly, so
// that `scale` is the radius to the last bit.
Surface ball() {
  constexpr std::size_t kRows = 20;
  Surface surface{"Ball", 0, {}, {}};
  std::array<Vec3, 4> equator{Vec3::UnitX(), -Vec3::UnitZ(), -Vec3::UnitX(), Vec3::UnitZ()};
  // Row r from the top has 4 r vertices; the lower half mirrors the upper one.
  const auto rowStart = [](std::size_t r) { return r == 0 ? 0 : 1 + 2 * r * (r - 1); };
  std::vector<Vec3> upper{Vec3::UnitY()};
  for (std::size_t r = 1; r <= kRows; ++r)
    for (std::size_t i = 0; i < 4 * r; ++i) {
      const auto weight = [&](std::size_t steps) { return std::sin(pi / 2 * fraction(steps, kRows)); };
      const Vec3 &from = equator[i / r], &to = equator[(i / r + 1) % 4];
      const Vec3 blown = weight(r - i % r) * from + weight(i % r) * to + weight(kRows - r) * Vec3::UnitY();
      upper.push_back(blown.normalized());
    }
  for (const Vec3& vertex : upper) surface.add(vertex);
  const std::size_t inner = rowStart(kRows);  // vertices above the equator
  for (std::size_t v = 0; v < inner; ++v) surface.add(upper[v].cwiseProduct(Vec3(1, -1, 1)));
  const auto addBoth = [&](std::size_t a, std::size_t b, std::size_t c) {
    const auto below = [&](std::size_t v) { return v < inner ? upper.size() + v : v; };
    surface.addTriangle(a, b, c, 1);
    surface.addTriangle(below(a), below(c), below(b), 1);
  };
  for (std::size_t r = 0; r < kRows; ++r)
    for (std::size_t side = 0; side < 4; ++side)
      for (std::size_t i = 0; i <= r; ++i) {
        const auto high = [&](std::size_t k) { return rowStart(r) + (r == 0 ? 0 : (side * r + k) % (4 * r)); };
        const auto low = [&](std::size_t k) { return rowStart(r + 1) + (side * (r + 1) + k) % (4 * (r + 1)); };
        addBoth(high(i), low(i), low(i + 1));
        if (i < r) addBoth(high(i), low(i + 1), high(i + 1));
      }
  return surface;
}

// The faces of a block whose corners are those of a cube in the order of binary numbers zyx.
void addBlock(Surface& surface) {
  surface.addQuad(1, 3, 7, 5, kSharp);  // +x
  surface.addQuad(0, 4, 6, 2, kSharp);  // -x
  surface.addQuad(2, 6, 7, 3, kSharp);  // +y
  surface.addQuad(0, 1, 5, 4, kSharp);  // -y
  surface.addQuad(4, 5, 7, 6, kSharp);  // +z
  surface.addQuad(0, 2, 3, 1, kSharp);  // -z
}

Surface box() {
  const Vec3 half(0.25, 0.125, 0.0625);  // m; exact in a float
  Surface surface{"Box", 0, {}, {}};
  for (std::size_t v = 0; v < 8; ++v)
    surface.add(half.cwiseProduct(Vec3(v & 1 ? 1 : -1, v & 2 ? 1 : -1, v & 4 ? 1 : -1)));
  addBlock(surface);
  return surface;
}

// A stone of an arch that is round the z axis, at its crown; so that the faces of neighbours lie in each other, their
// slope and all vertices are exact in floats. Fifteen of them make 178.96 degrees.
Surface voussoir() {
  constexpr double kSlope = 107.0 / 1024, kInner = 59.0 / 32, kOuter = 69.0 / 32, kHalfWidth = 0.25;  // -, m, m, m
  Surface surface{"Voussoir", 0, {}, {}};
  for (const double z : {-kHalfWidth, kHalfWidth})
    for (const double height : {kInner, kOuter})
      for (const double slope : {-kSlope, kSlope}) surface.add({slope * height, height, z});
  addBlock(surface);
  return surface;
}

// The L of 3 x 2 squares without its upper right 2 x 1, one square thick; one corner is the origin.
Surface lPrism() {
  constexpr double kUnit = 0.1;  // m
  const std::array<Eigen::Vector2d, 6> outline{{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}}};
  Surface surface{"LPrism", 0, {}, {}};
  for (const double z : {0.0, 1.0})
    for (const auto& point : outline) surface.add(kUnit * Vec3(point.x(), point.y(), z));
  for (std::size_t i = 0; i < 6; ++i) surface.addQuad(i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i, kSharp);
  const std::array<std::array<std::size_t, 3>, 4> cap{{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}};
  for (const auto& [a, b, c] : cap) {
    surface.addTriangle(a, c, b, kSharp);
    surface.addTriangle(6 + a, 6 + b, 6 + c, kSharp);
  }
  return surface;
}

// A cone on the ground, as high as wide; its side is smooth around, and the tip is a corner of each facet of its own.
Surface cone() {
  constexpr std::size_t kSides = 24;
  constexpr double kRadius = 0.15, kHeight = 0.3;  // m
  Surface surface{"Cone", 0, {}, {}};
  surface.add({0, kHeight, 0});
  surface.add(Vec3::Zero());
  for (std::size_t i = 0; i < kSides; ++i) surface.add(kRadius * aroundY(2 * pi * fraction(i, kSides)));
  for (std::size_t i = 0; i < kSides; ++i) {
    const std::size_t here = 2 + i, next = 2 + (i + 1) % kSides;
    surface.addTriangle(0, here, next, 1);
    surface.addTriangle(1, next, here, kSharp);
  }
  return surface;
}

/// A tube around y, divided into that many sections of that many sides; lengths in m.
Surface tubeRing(const char* name, double radius, double tubeRadius, std::size_t count, std::size_t sides) {
  std::vector<Section> sections;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 outward = aroundY(2 * pi * fraction(i, count));
    sections.push_back({radius * outward, outward, -Vec3::UnitY(), tubeRadius});
  }
  Surface surface{name, 0, {}, {}};
  addTube(sections, sides, true, surface);
  return surface;
}

// A tube along the curve that winds twice around y and three times around the core circle of a torus.
Surface torusKnot() {
  constexpr double kRadius = 0.105, kWinding = 0.05, kTubeRadius = 0.024;  // m
  constexpr std::size_t kSections = 240, kSides = 20;
  std::vector<Section> sections;
  for (std::size_t i = 0; i < kSections; ++i) {
    const double t = 2 * pi * fraction(i, kSections);
    const Vec3 radial = aroundY(2 * t), along = Vec3(-std::sin(2 * t), 0, -std::cos(2 * t));
    const double distance = kRadius + kWinding * std::cos(3 * t);
    const Vec3 tangent = (2 * distance * along - 3 * kWinding * std::sin(3 * t) * radial +
                          3 * kWinding * std::cos(3 * t) * Vec3::UnitY())
                             .normalized();
    const Vec3 fromCore = std::cos(3 * t) * radial + std::sin(3 * t) * Vec3::UnitY();  // at right angles to tangent
    sections.push_back({distance * radial + kWinding * std::sin(3 * t) * Vec3::UnitY(), fromCore,
                        tangent.cross(fromCore), kTubeRadius});
  }
  Surface surface{"TorusKnot", 0, {}, {}};
  addTube(sections, kSides, true, surface);
  return surface;
}

Surface gear() {
  constexpr double kTipRadius = 0.15, kRootRadius = 0.12, kHoleRadius = 0.05, kThickness = 0.04;  // m
  constexpr std::size_t kTeeth = 12;
  Outline outer, hole;
  hole.wallSmoothing = 1;
  for (std::size_t i = 0; i < 4 * kTeeth; ++i) {
    const bool isTip = i % 4 == 1 || i % 4 == 2;
    const double start = 2 * pi * fraction(i / 4, kTeeth), step = 2 * pi / static_cast<double>(kTeeth);
    const double angle = start + step * std::array{0.05, 0.2, 0.4, 0.55}[i % 4];
    const double holeAngle = 2 * pi * fraction(i, 4 * kTeeth) + 0.05 * step;
    outer.points.push_back((isTip ? kTipRadius : kRootRadius) * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    hole.points.push_back(kHoleRadius * Eigen::Vector2d(std::cos(holeAngle), std::sin(holeAngle)));
  }
  Surface surface{"Gear", 0, {}, {}};
  addPlateWithHole(outer, hole, kThickness, surface);
  return surface;
}

// A spinning top that stands on its tip, the origin: rings around y from the tip to the end of the stem. Twelve flat
// facets show that it turns.
Surface spinningTop() {
  constexpr std::size_t kSides = 12;
  const std::array<Eigen::Vector2d, 6> rings{
      // radius, height in m
      {{0.018, 0.014}, {0.06, 0.05}, {0.062, 0.058}, {0.016, 0.076}, {0.007, 0.09}, {0.007, 0.125}}};
  Surface surface{"SpinningTop", 0, {}, {}};
  surface.add(Vec3::Zero());
  for (const auto& ring : rings)
    for (std::size_t i = 0; i < kSides; ++i)
      surface.add(ring.x() * aroundY(2 * pi * fraction(i, kSides)) + ring.y() * Vec3::UnitY());
  surface.add({0, rings.back().y(), 0});
  const std::size_t end = surface.vertices.size() - 1;
  for (std::size_t i = 0; i < kSides; ++i) {
    const std::size_t j = (i + 1) % kSides;
    surface.addTriangle(0, 1 + j, 1 + i, kSharp);
    for (std::size_t row = 1; row + kSides < end; row += kSides)
      surface.addQuad(row + i, row + j, row + kSides + j, row + kSides + i, kSharp);
    surface.addTriangle(end, end - kSides + i, end - kSides + j, kSharp);
  }
  return surface;
}

// One tube, bent twice: a foot that stands on the board, a leg, a rail, a leg, a foot.
Surface railWithLegs(const std::string& name, double z) {
  using namespace frame;
  constexpr std::size_t kSides = 24, kBendSteps = 12;
  const double top = kRailHeight - kBendRadius, end = kRailLength / 2 - kBendRadius;
  std::vector<Section> sections;
  const auto add = [&](double x, double y, double angle, double radius) {  // the tube runs at `angle` above +x
    sections.push_back({Vec3(x, y, z), Vec3(-std::sin(angle), std::cos(angle), 0), Vec3::UnitZ(), radius});
  };
  add(-kRailLength / 2, kBoardThickness, pi / 2, kFootRadius);
  add(-kRailLength / 2, kBoardThickness + kFootHeight, pi / 2, kTubeRadius);
  for (const double side : {-1.0, 1.0})
    for (std::size_t i = 0; i <= kBendSteps; ++i) {
      const double angle = side < 0 ? pi / 2 * (1 - fraction(i, kBendSteps)) : -pi / 2 * fraction(i, kBendSteps);
      add(side * end - kBendRadius * std::sin(angle), top + kBendRadius * std::cos(angle), angle, kTubeRadius);
    }
  add(kRailLength / 2, kBoardThickness + kFootHeight, -pi / 2, kTubeRadius);
  add(kRailLength / 2, kBoardThickness, -pi / 2, kFootRadius);
  Surface surface{name, 0, {}, {}};
  addTube(sections, kSides, false, surface);
  return surface;
}

Surface board() {
  using namespace frame;
  Surface surface{"Board", 1, {}, {}};
  const auto addRectangle = [&](double height, double inset) {
    const double x = kBoardLength / 2 - inset, z = kBoardWidth / 2 - inset;
    for (const auto& [sx, sz] : {std::pair{-1, 1}, {1, 1}, {1, -1}, {-1, -1}}) surface.add({sx * x, height, sz * z});
  };
  addRectangle(0, 0);
  addRectangle(kBoardThickness - kBoardBevel, 0);
  addRectangle(kBoardThickness, kBoardBevel);
  for (std::size_t i = 0; i < 4; ++i)
    for (const std::size_t row : {0, 4}) {
      const std::size_t j = (i + 1) % 4;
      surface.addQuad(row + i, row + j, row + 4 + j, row + 4 + i, kSharp);
    }
  surface.addQuad(3, 2, 1, 0, kSharp);
  surface.addQuad(8, 9, 10, 11, kSharp);
  return surface;
}

Model cradleFrame() {
  const double z = frame::kRailDistance / 2;
  return {"cradle_frame.3ds",
          {{"Chrome", {196, 202, 208}}, {"Walnut", {92, 58, 38}}},
          {railWithLegs("RailFront", z), railWithLegs("RailBack", -z), board()}};
}

}  // namespace

std::vector<Model> allModels() {
  return {{"ball.3ds", {{"Steel", {200, 205, 212}}}, {ball()}},
          {"box.3ds", {{"Birch", {214, 182, 138}}}, {box()}},
          {"cone.3ds", {{"Amber", {226, 160, 48}}}, {cone()}},
          cradleFrame(),
          {"die.3ds", {{"Ivory", {238, 231, 214}, "die.png"}}, {die()}},
          {"gear.3ds", {{"Brass", {196, 160, 82}}}, {gear()}},
          {"l_prism.3ds", {{"Teal", {42, 132, 138}}}, {lPrism()}},
          {"ring.3ds", {{"Brass", {196, 160, 82}}}, {tubeRing("Ring", 0.5, 0.025, 96, 20)}},
          {"rocks.3ds", {{"Basalt", {110, 108, 104}}}, rocks()},
          {"spinning_top.3ds", {{"Cherry", {168, 58, 42}}}, {spinningTop()}},
          {"t_handle.3ds", {{"Steel", {168, 176, 188}}}, {tHandle()}},
          {"torus.3ds", {{"Coral", {222, 98, 76}}}, {tubeRing("Torus", 0.12, 0.045, 64, 32)}},
          {"torus_knot.3ds", {{"Indigo", {76, 84, 178}}}, {torusKnot()}},
          {"voussoir.3ds", {{"Sandstone", {206, 184, 146}}}, {voussoir()}}};
}

}  // namespace cradle::assets
