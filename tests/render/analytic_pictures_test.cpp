// Pictures whose areas, places and brightness follow from closed forms.

#include <gtest/gtest.h>

#include <cmath>

#include "math/rotation.h"
#include "render/camera.h"
#include "render/scene_builder.h"

namespace cradle {
namespace {

constexpr int kWidth = 640, kHeight = 480;

double linearFromByte(double byte) {
  const double c = byte / 255;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// The light that a byte stands for: the tone curve y = x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14), solved for x.
double lightFromByte(double byte) {
  const double y = linearFromByte(byte);
  const double a = 2.51 - 2.43 * y, b = 0.03 - 0.59 * y, c = -0.14 * y;
  return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

/// Area and centroid of what one picture shows darker than another: pixels count by how much less light they show,
/// where `darkest` (0..1, of the brighter picture) counts fully.
struct Patch {
  double area = 0;  // pixels
  Eigen::Vector2d center = {0, 0};
};

Patch manifoldOf(const Image& dark, const Image& bright, double darkest, double (*light)(const Image&, int, int)) {
  Patch patch;
  for (int y = 0; y < bright.height; ++y) {
    for (int x = 0; x < bright.width; ++x) {
      const double share = (1 - light(dark, x, y) / light(bright, x, y)) / (1 - darkest);
      patch.area += share;
      patch.center += share * Eigen::Vector2d(x + 0.5, y + 0.5);
    }
  }
  patch.center /= patch.area;
  return patch;
}

/// Edges are averaged in bytes, shadows in light.
double byteAt(const Image& image, int x, int y) {
  return image.at(x, y)[1];
}
double lightAt(const Image& image, int x, int y) {
  return lightFromByte(image.at(x, y)[1]);
}

/// A picture in a fixed view; all bodies near the origin. `keys` are where the camera is in other pictures.
Image drawWith(const Scene& scene, const Camera& camera, const std::vector<Camera>& keys = {}) {
  const View view{camera, Bounds(Vec3(-1.5, -1.5, -1.5), Vec3(1.5, 1.5, 1.5)), {}, 0, keys};
  Renderer renderer(scene, view, kWidth, kHeight);
  return renderer.render(startFrame(scene));
}

/// A ball that sends out no light at all, in a bright studio without lamps.
Scene blackBallScene(const Vec3& center, double radius) {
  Scene scene = emptyScene();
  scene.lights[0].intensity = 0;
  scene.materials[0].baseColor = Vec3f::Zero();
  scene.materials[0].metallic = 1;
  addBody(scene, Sphere{radius}, {Quat::Identity(), center});
  return scene;
}

// A ball of radius r in direction theta off the axis and at distance d is seen in a cone of half angle alpha, sin alpha
// = r/d. The plane of the picture, at f pixels, cuts it in an ellipse with the semi-axes
//   a = f sin alpha cos alpha / (cos^2 theta - sin^2 alpha),  b = f sin alpha / sqrt(cos^2 theta - sin^2 alpha)
// whose centre is f sin theta cos theta / (cos^2 theta - sin^2 alpha) from the middle.
TEST(AnalyticPicture, OutlineOfABallIsTheEllipseOfItsCone) {
  const Camera camera = cameraAt({0, 0, 4}, {0, 0, 0}, 60 * M_PI / 180);
  const double f = kHeight / 2.0 / std::tan(30 * M_PI / 180);
  const Image background = drawWith(blackBallScene({0, 0, 9}, 0.1), camera);  // behind the camera
  for (const Vec3& center : {Vec3(0, 0, 0), Vec3(1.2, 0.5, 0), Vec3(-0.9, -0.8, 0.5)}) {
    const double radius = 0.4;
    const Vec3 towards = center - camera.position;
    const double sine2 = std::pow(radius / towards.norm(), 2), cosine = -towards.z() / towards.norm();
    const double cut = cosine * cosine - sine2;
    const double area = M_PI * f * f * sine2 * std::sqrt(1 - sine2) / std::pow(cut, 1.5);
    const double offset = f * std::sqrt(1 - cosine * cosine) * cosine / cut;
    const double beside = std::hypot(towards.x(), towards.y());
    const Vec3 aside = beside > 0 ? Vec3(towards.x() / beside, towards.y() / beside, 0) : Vec3(Vec3::Zero());

    const Patch patch = manifoldOf(drawWith(blackBallScene(center, radius), camera), background, 0, byteAt);
    // Each of about 450 pixels on the outline counts its 4 samples: an error of up to 1/8, 1.5 pixels together; four
    // times that, and the outline's polygon, which is as large as the ellipse to 1e-4.
    EXPECT_NEAR(patch.area, area, 6 + 1e-4 * area);
    EXPECT_NEAR(patch.center.x(), kWidth / 2.0 + offset * aside.x(), 0.05);
    EXPECT_NEAR(patch.center.y(), kHeight / 2.0 - offset * aside.y(), 0.05);
  }
}

TEST(AnalyticPicture, CylinderAndBoxHaveTheAreaOfTheirOutline) {
  // Seen from so far that perspective changes areas by less than 1 %: the cylinder along the view is a circle, across
  // it a rectangle; the faces that are nearer by h appear larger by d / (d - h).
  const Camera camera = cameraAt({0, 0, 60}, {0, 0, 0}, 2 * std::atan(1.2 / 60));
  const double pixelsPerMetre = kHeight / 2.4;
  const Image background = drawWith(blackBallScene({0, 0, 90}, 0.1), camera);
  const auto areaOf = [&](const Shape& shape, const Quat& turn) {
    Scene scene = blackBallScene({0, 0, 0}, 1);
    scene.bodies[0].shape = shape;
    scene.bodies[0].worldFromBody.rotation = turn;
    return manifoldOf(drawWith(scene, camera), background, 0, byteAt).area / (pixelsPerMetre * pixelsPerMetre);
  };
  const Quat upright = Quat::Identity(), towardsEye = rotationAbout(Vec3::UnitX(), M_PI / 2);
  const double nearer = std::pow(60 / 59.6, 2);
  EXPECT_NEAR(areaOf(Cylinder{0.5, 0.8}, towardsEye), M_PI * 0.25 * nearer, 1e-3);
  EXPECT_NEAR(areaOf(Cylinder{0.5, 0.8}, upright), 0.8, 1e-2);
  EXPECT_NEAR(areaOf(Box{{0.6, 0.7, 0.8}}, upright), 0.42 * nearer, 1e-3);
}

TEST(AnalyticPicture, NearCylinderIsAsWideAsItsTangents) {
  // An upright cylinder of radius r at distance d: its sides are seen at the angle asin(r/d) to the left and right.
  const Camera camera = cameraAt({0, 0, 1}, {0, 0, 0}, 60 * M_PI / 180);
  const double f = kHeight / 2.0 / std::tan(30 * M_PI / 180);
  Scene scene = blackBallScene({0, 0, 9}, 0.1);
  const Image background = drawWith(scene, camera);
  scene.bodies[0].shape = Cylinder{0.5, 20};
  scene.bodies[0].worldFromBody.translation = Vec3::Zero();
  const Patch patch = manifoldOf(drawWith(scene, camera), background, 0, byteAt);
  // Edges are upright: the 4 samples of a pixel lie in 4 columns, an error of up to 1/8 pixel on either side.
  EXPECT_NEAR(patch.area / kHeight, 2 * f * std::tan(std::asin(0.5)), 0.25);
}

// A wall that faces the camera, lit at 60 degrees. Lambert: albedo times cosine; and the highlight of the roughest
// dielectric, straight on: F D G / (4 nl nv) nl with alpha = 1 + 0.035 (the width of the lamp). Surroundings are taken
// off as the same picture without the lamp. A white lamp's green is tinted by 1.02.
TEST(AnalyticPicture, MattWallSendsOutAlbedoTimesCosine) {
  const double albedo = 0.3, intensity = 7, nl = std::cos(60 * M_PI / 180);
  const auto brightness = [&](double lamp) {
    Scene scene = emptyScene();
    const float code = static_cast<float>(1.055 * std::pow(albedo, 1 / 2.4) - 0.055);
    scene.materials[0].baseColor = Vec3f::Constant(code);
    scene.lights[0].direction = Vec3(0, -std::sin(60 * M_PI / 180), -nl);
    scene.lights[0].intensity = lamp;
    addBody(scene, Box{{2, 2, 0.2}}, {});
    return drawWith(scene, cameraAt({0, 0, 5}, {0, 0, 0}, 0.6)).at(kWidth / 2, kHeight / 2)[1];
  };
  const double alpha = 1.035, nv = 1, vh = std::cos(30 * M_PI / 180);
  const double fresnel = 0.04 + 0.96 * std::pow(1 - vh, 5);
  const double d = vh * vh * (alpha * alpha - 1) + 1;
  const double visibility = 0.5 / (2 * nl * nv + (nl + nv - 2 * nl * nv) * alpha);
  const double highlight = fresnel * alpha * alpha / (d * d) * visibility * nl;
  const double expected = 1.02 * intensity / M_PI * (albedo * nl + highlight);
  const int lit = brightness(intensity), dark = brightness(0);
  // Two roundings by half a step.
  const double rounding =
      lightFromByte(lit + 0.5) - lightFromByte(lit) + lightFromByte(dark + 0.5) - lightFromByte(dark);
  EXPECT_NEAR(lightFromByte(lit) - lightFromByte(dark), expected, rounding);
}

// A rod of half a pixel's width is drawn 1.1 pixels wide, in half of the samples: no row goes without, and all together
// are as dark as the rod is wide.
TEST(AnalyticPicture, RodThinnerThanAPixelIsNotBroken) {
  const Camera camera = cameraAt({0, 0, 4}, {0, 0, 0}, 60 * M_PI / 180);
  const double pixel = 2 * 4 * std::tan(30 * M_PI / 180) / kHeight;
  Scene scene = blackBallScene({0, 0, 9}, 0.1);
  const Image background = drawWith(scene, camera);
  scene.bodies[0].shape = Cylinder{0.275 * pixel, 10};
  scene.bodies[0].worldFromBody = {rotationAbout(Vec3::UnitZ(), 0.13), Vec3::Zero()};
  const Image image = drawWith(scene, camera);
  double sum = 0;
  for (int y = 0; y < kHeight; ++y) {
    double row = 0;
    for (int x = 0; x < kWidth; ++x) row += 1 - byteAt(image, x, y) / byteAt(background, x, y);
    EXPECT_GE(row, 0.2) << y;  // one sample of four, and rounding
    sum += row;
  }
  EXPECT_NEAR(sum / kHeight, 0.55 / std::cos(0.13), 0.06);
}

/// A ball over a ground, seen from straight above; the lamp shines aside.
Scene shadowScene(const Vec3& center, double radius, const Vec3& light) {
  Scene scene = emptyScene();
  scene.lights[0].direction = light.normalized();
  scene.materials[0].baseColor = Vec3f::Constant(0.5f);
  addBody(scene, Plane{}, {Quat::Identity(), {0, -1, 0}}, Motion::fixed);
  addBody(scene, Sphere{radius}, {Quat::Identity(), center});
  return scene;
}

TEST(AnalyticPicture, ShadowOfABallFallsWhereTheLightTakesIt) {
  // The ground is 5 m below the camera, 480 rows are 2 * 5 * tan(20 degrees).
  const Camera camera = cameraAt({0, 4, 0}, {0, -1, 0}, 40 * M_PI / 180);
  const double pixelsPerMetre = kHeight / (10 * std::tan(20 * M_PI / 180));
  const Vec3 light(-1, -1.2, 0.4), center(0.9, 0.5, -0.3);
  const double radius = 0.2;
  // The ball itself is not wanted in the picture: the camera sees only its shadow, for it is outside on the right.
  const Vec3 shadow = center + (center.y() + 1) / 1.2 * light;
  const Vec3 ballInView = camera.position + (center - camera.position) * (5 / (4 - center.y()));
  ASSERT_GT((ballInView - shadow).norm(), 1);

  const Image bright = drawWith(shadowScene({0, 40, 0}, radius, light), camera);
  Image dark = drawWith(shadowScene(center, radius, light), camera);
  // Leave the ball out: its pixels as if it were not there.
  const int border = static_cast<int>(kWidth / 2 + pixelsPerMetre * 0.45);
  for (int y = 0; y < kHeight; ++y)
    for (int x = border; x < kWidth; ++x) std::copy_n(bright.at(x, y), 3, dark.at(x, y));
  ASSERT_LT(pixelsPerMetre * (shadow.x() + radius * 2), border - kWidth / 2);

  const Eigen::Vector2d expected(kWidth / 2.0 + pixelsPerMetre * shadow.x(),
                                 kHeight / 2.0 + pixelsPerMetre * shadow.z());
  const int x = static_cast<int>(expected.x()), y = static_cast<int>(expected.y());
  const double darkest = lightAt(dark, x, y) / lightAt(bright, x, y);
  EXPECT_LT(darkest, 0.45);
  const Patch patch = manifoldOf(dark, bright, darkest, lightAt);
  // A texel of the map is 1/800 of the picture's height: soft edges leave a fraction of it.
  EXPECT_NEAR(patch.center.x(), expected.x(), 0.3);
  EXPECT_NEAR(patch.center.y(), expected.y(), 0.3);
  // An ellipse pi r (r / sine of the light's height): soft edges take from it what they give to its surroundings. The
  // middle's byte is off by up to half a step of 60: 2 %; the ball is drawn as a polygon whose depths are those of its
  // middle third: 2 %.
  const double sine = 1.2 / light.norm();
  const double area = M_PI * radius * radius / sine * pixelsPerMetre * pixelsPerMetre;
  EXPECT_NEAR(patch.area / area, 1, 0.04);
}

// The lamp is a disc of angular radius atan 0.03. On the ground, d below an edge that hides half of it, the light falls
// as the disc's area beside a chord: between 10 % and 90 % over 2 * 0.687 * 0.03 d. Edges are as soft up to 16 texels
// of the shadow map, 1/50 of a picture's height: the film has pictures of 2 m, seen by another camera.
TEST(AnalyticPicture, ShadowsEdgeIsAsSoftAsItIsFarFromWhatThrowsIt) {
  const Camera camera = cameraAt({3, 0, 0}, {0.5, -1, 0}, 0.2), wide = cameraAt({3, 0, 0}, {0.5, -1, 0}, 0.66);
  const auto widthUnder = [&](double height) {
    Scene scene = shadowScene({0, 40, 0}, 0.1, {0, -1, 0});
    const Image bright = drawWith(scene, camera, {wide});
    scene.bodies[1].shape = Box{{1, 0.02, 3}};
    scene.bodies[1].worldFromBody.translation = Vec3(0, height - 1.01, 0);  // its upper face is met by the light
    const Image dark = drawWith(scene, camera, {wide});
    const auto shareAt = [&](double place) {  // mean over some lines of pixels
      double sum = 0;
      for (int i = -20; i <= 20; ++i) {
        const Eigen::Vector2d pixel = projectToPixel(camera, {place, -1, 0.005 * i}, kWidth, kHeight);
        const int x = static_cast<int>(pixel.x()), y = static_cast<int>(pixel.y());
        sum += lightAt(dark, x, y) / lightAt(bright, x, y) / 41;
      }
      return sum;
    };
    const double darkest = shareAt(0.3), open = shareAt(0.7);
    const auto placeOf = [&](double lit) {
      double place = 0.3;
      while ((shareAt(place) - darkest) / (open - darkest) < lit) place += 1e-3;
      return place;
    };
    EXPECT_NEAR(placeOf(0.5), 0.5, 0.006) << height;  // a texel of the map
    return placeOf(0.9) - placeOf(0.1);
  };
  for (const double height : {0.4, 0.8, 1.2}) {
    // 24 samples tell the tenth to half of one; rows of pixels are 3 mm apart, and rounding of bytes adds as much.
    const double expected = 2 * 0.687 * 0.03 * height;
    EXPECT_NEAR(widthUnder(height), expected, 0.1 * expected + 0.004) << height;
  }
}

TEST(AnalyticPicture, LitWallThrowsNoShadowOnItself) {
  // Lamps from steep to grazing; on the wall only the smooth change of its highlight is allowed.
  for (const double angle : {10.0, 45.0, 70.0, 85.0}) {
    Scene scene = emptyScene();
    scene.lights[0].direction =
        Vec3(std::sin(angle * M_PI / 180) * 0.8, -std::sin(angle * M_PI / 180) * 0.6, -std::cos(angle * M_PI / 180));
    addBody(scene, Box{{2, 2, 0.2}}, {});
    const Image image = drawWith(scene, cameraAt({0, 0, 5}, {0, 0, 0}, 0.6));
    int largestStep = 0;
    for (int y = 100; y < kHeight - 100; ++y)
      for (int x = 200; x < kWidth - 200; ++x)
        for (int channel = 0; channel < 3; ++channel) {
          largestStep = std::max(largestStep, std::abs(image.at(x, y)[channel] - image.at(x + 1, y)[channel]));
          largestStep = std::max(largestStep, std::abs(image.at(x, y)[channel] - image.at(x, y + 1)[channel]));
        }
    EXPECT_LE(largestStep, 1) << angle << " degrees";
  }
}

TEST(AnalyticPicture, LitBallThrowsNoShadowOnItself) {
  // Brightness of a matt ball falls steadily from its lit to its dark side: no pixel may be darker than both neighbours
  // along that way by more than rounding.
  Scene scene = emptyScene();
  scene.lights[0].direction = Vec3(-1, 0, -0.3).normalized();
  addBody(scene, Sphere{1}, {});
  const Image image = drawWith(scene, cameraAt({0, 0, 5}, {0, 0, 0}, 0.6));
  for (int y = kHeight / 2 - 60; y < kHeight / 2 + 60; ++y)
    for (int x = kWidth / 2 - 120; x < kWidth / 2 + 80; ++x)
      EXPECT_LE(image.at(x, y)[1], image.at(x + 1, y)[1] + 1) << x << " " << y;
}

// A ball of radius r that rests on the ground hides (r/d)^2 cos of the sky, d the distance of its centre and cos = r/d
// of the angle to the vertical.
TEST(AnalyticPicture, BallHidesTheSkyFromTheGroundAroundIt) {
  const double radius = 0.15;
  const Camera camera = cameraAt({0, 0.6, 0}, {0, -1, 0}, 50 * M_PI / 180);  // near: hardly any haze before the ground
  Scene scene = shadowScene({0, -1 + radius, 0}, radius, {0, -1, 0});
  scene.materials[0].baseColor = Vec3f::Ones();
  scene.lights[0].intensity = 0;  // the sky alone
  const Image image = drawWith(scene, camera);
  scene.bodies[1].worldFromBody.translation.y() = 50;
  const Image open = drawWith(scene, camera);
  for (const double aside : {0.22, 0.27, 0.35}) {
    for (int side = 0; side < 4; ++side) {
      double mean = 0;  // around half the ball, so that the rounding of dark bytes, up to 0.02, averages out
      for (int i = 0; i < 100; ++i) {
        const double angle = M_PI * i / 100 + M_PI / 2 * side;
        const Vec3 place(aside * std::cos(angle), -1, aside * std::sin(angle));
        const Eigen::Vector2d pixel = projectToPixel(camera, place, kWidth, kHeight);
        const int x = static_cast<int>(pixel.x()), y = static_cast<int>(pixel.y());
        mean += lightAt(image, x, y) / lightAt(open, x, y) / 100;
      }
      // A texel of the map is 2 cm wide: between its texels, the share is off by up to 2 mm of its slope of 2 a metre.
      EXPECT_NEAR(mean, 1 - std::pow(radius / std::hypot(aside, radius), 3), 0.008) << aside << " side " << side;
    }
  }
}

TEST(AnalyticPicture, ShadowMeetsWhatThrowsIt) {
  // A box on the ground, seen from the side away from the light: close to its foot the ground is as dark as farther in
  // the shadow; a gap would show as light ground.
  Scene scene = emptyScene();
  scene.materials[0].baseColor = Vec3f::Constant(0.5f);
  scene.lights[0].direction = Vec3(0, -1, 1).normalized();
  addBody(scene, Plane{}, {Quat::Identity(), {0, -0.5, 0}}, Motion::fixed);
  addBody(scene, Box{{1, 1, 1}}, {});
  const Camera camera = cameraAt({0.3, 1.5, 5}, {0, 0, 0}, 0.6);
  const Image dark = drawWith(scene, camera);
  scene.bodies.back().worldFromBody.translation.y() = 50;
  const Image bright = drawWith(scene, camera);
  const auto shareAt = [&](const Vec3& point) {
    const Eigen::Vector2d pixel = projectToPixel(camera, point, kWidth, kHeight);
    const int x = static_cast<int>(pixel.x()), y = static_cast<int>(pixel.y());
    return dark.at(x, y)[1] / static_cast<double>(bright.at(x, y)[1]);
  };
  for (const double distance : {0.01, 0.03, 0.1, 0.3}) EXPECT_LT(shareAt({0.2, -0.5, 0.5 + distance}), 0.7) << distance;
  EXPECT_GT(shareAt({0.9, -0.5, 0.6}), 0.9);
}

}  // namespace
}  // namespace cradle
