#include <limits>
#include <random>

#include "sample_trajectory.h"

namespace cradle {
namespace {

TEST(TrajectoryFile, KeepsTheHeader) {
  const TemporaryFolder folder;
  writeSample(folder.file("a.sqlite"), 1);
  const TrajectoryReader reader(folder.file("a.sqlite"));
  const TrajectoryHeader expected = sampleHeader();
  const TrajectoryHeader& header = reader.header();
  EXPECT_EQ(header.scene, expected.scene);
  EXPECT_EQ(header.scenePath, expected.scenePath);
  EXPECT_EQ(header.version, expected.version);
  EXPECT_EQ(header.plan, expected.plan);
  EXPECT_EQ(header.accuracy, expected.accuracy);
  EXPECT_EQ(header.method, expected.method);
  ASSERT_EQ(header.bodies.size(), expected.bodies.size());
  for (std::size_t i = 0; i < expected.bodies.size(); ++i) {
    EXPECT_EQ(header.bodies[i].name, expected.bodies[i].name);
    EXPECT_EQ(header.bodies[i].isDynamic, expected.bodies[i].isDynamic);
    EXPECT_EQ(header.bodies[i].isDriven, expected.bodies[i].isDriven);
    EXPECT_EQ(header.bodies[i].mesh, expected.bodies[i].mesh);
    EXPECT_EQ(header.bodies[i].shape, expected.bodies[i].shape);
    EXPECT_EQ(header.bodies[i].massProperties.mass, expected.bodies[i].massProperties.mass);
    EXPECT_EQ(header.bodies[i].massProperties.centerOfMass, expected.bodies[i].massProperties.centerOfMass);
    EXPECT_EQ(header.bodies[i].massProperties.inertiaTensor, expected.bodies[i].massProperties.inertiaTensor);
  }
  ASSERT_EQ(header.joints.size(), expected.joints.size());
  for (std::size_t i = 0; i < expected.joints.size(); ++i) {
    EXPECT_EQ(header.joints[i].name, expected.joints[i].name);
    EXPECT_EQ(header.joints[i].kind, expected.joints[i].kind);
    EXPECT_EQ(header.joints[i].bodyA, expected.joints[i].bodyA);
    EXPECT_EQ(header.joints[i].bodyB, expected.joints[i].bodyB);
  }
}

/// The sample, with a texture on the first range of its mesh, and another that a material of the scene has.
TrajectoryHeader texturedHeader() {
  TrajectoryHeader header = sampleHeader();
  const auto texture = std::make_shared<const Texture>(Texture{"brass.png", std::string("\x89PNG\0 and more", 14)});
  header.textures = {std::make_shared<const Texture>(Texture{"../wood.jpg", "\xff\xd8\xff"})};
  DrawnMesh& drawn = header.meshes[0].drawn;
  drawn.materials[0].texture = texture;
  for (std::size_t i = 0; i < drawn.vertices.size(); ++i)
    drawn.textureCoordinates.push_back({0.1f * static_cast<float>(i), -3});
  return header;
}

TEST(TrajectoryFile, KeepsTexturesThoseOfTheSceneFirst) {
  const TemporaryFolder folder;
  const TrajectoryHeader expected = texturedHeader();
  writeSample(folder.file("a.sqlite"), 1, expected);
  const TrajectoryReader reader(folder.file("a.sqlite"));
  const TrajectoryHeader& header = reader.header();
  ASSERT_EQ(header.textures.size(), 2u);
  EXPECT_EQ(header.textures[0]->name, "../wood.jpg");
  EXPECT_EQ(header.textures[0]->bytes, expected.textures[0]->bytes);
  const std::vector<ModelMaterial>& materials = header.meshes.at(0).drawn.materials;
  EXPECT_EQ(materials.at(0).texture, header.textures[1]);
  EXPECT_EQ(header.textures[1]->name, "brass.png");
  EXPECT_EQ(header.textures[1]->bytes, expected.meshes[0].drawn.materials[0].texture->bytes);
  EXPECT_EQ(materials.at(1).texture, nullptr);
  EXPECT_EQ(header.meshes[0].drawn.textureCoordinates, expected.meshes[0].drawn.textureCoordinates);
}

TEST(TrajectoryFile, KeepsMeshesAndWeldsTheSolidAgain) {
  const TemporaryFolder folder;
  writeSample(folder.file("a.sqlite"), 1);
  const TrajectoryReader reader(folder.file("a.sqlite"));
  const Model expected = sampleModel();
  ASSERT_EQ(reader.header().meshes.size(), 1u);
  const Model& model = reader.header().meshes[0];
  EXPECT_EQ(model.name, expected.name);
  EXPECT_EQ(model.drawn.vertices, expected.drawn.vertices);
  EXPECT_EQ(model.drawn.normals, expected.drawn.normals);
  EXPECT_EQ(model.drawn.triangles, expected.drawn.triangles);
  ASSERT_EQ(model.drawn.materials.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(model.drawn.materials[i].name, expected.drawn.materials[i].name);
    EXPECT_EQ(model.drawn.materials[i].baseColor, expected.drawn.materials[i].baseColor);
    EXPECT_EQ(model.drawn.materials[i].firstTriangle, expected.drawn.materials[i].firstTriangle);
    EXPECT_EQ(model.drawn.materials[i].triangleCount, expected.drawn.materials[i].triangleCount);
  }
  EXPECT_EQ(model.solid.vertices.size(), 4u);
  EXPECT_EQ(model.solid.vertices, expected.solid.vertices);
  EXPECT_EQ(model.solid.triangles, expected.solid.triangles);
}

TEST(TrajectoryFile, NeedsNoName) {
  const TemporaryFolder folder;
  writeSample(folder.file("named.sqlite"), 30);
  const TrajectoryReader named(folder.file("named.sqlite"));
  const auto before = folder.count();
  const std::string elsewhere = std::getenv("TMPDIR") == nullptr ? "/tmp" : std::getenv("TMPDIR");
  setenv("TMPDIR", folder.path().c_str(), 1);
  TrajectoryWriter writer(named.header());
  for (long number = 0; number < named.frameCount(); ++number) writer.append(named.readFrame(number));
  EXPECT_EQ(folder.count(), before);
  writer.finish({});
  const TrajectoryReader reader(writer);
  EXPECT_EQ(reader.frameCount(), 30);
  EXPECT_EQ(reader.hashOfFrames(), named.hashOfFrames());
  EXPECT_EQ(folder.count(), before);
  setenv("TMPDIR", elsewhere.c_str(), 1);
}

TEST(TrajectoryFile, GivesFramesBackBitByBitInAnyOrder) {
  const TemporaryFolder folder;
  const long count = 40;
  writeSample(folder.file("a.sqlite"), count);
  const TrajectoryReader reader(folder.file("a.sqlite"));
  ASSERT_EQ(reader.frameCount(), count);
  std::vector<long> order;
  for (long number = 0; number < count; ++number) order.insert(order.end(), {number, number});
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  for (const long number : order) expectSameBits(reader.readFrame(number), sampleFrame(number));
}

TEST(TrajectoryFile, KeepsTheBitsOfExtremeNumbers) {
  using limits = std::numeric_limits<double>;
  const double extremes[] = {-0.0,    0.0,      limits::denorm_min(),   -limits::denorm_min(), limits::min(),
                             9.99e29, -9.99e29, std::nextafter(1.0, 2), 9007199254740993.0,    -3.0};
  const TemporaryFolder folder;
  Frame frame = sampleFrame(0);
  std::size_t next = 0;
  const auto extreme = [&] { return extremes[next++ % std::size(extremes)]; };
  const auto vector = [&] { return Vec3{extreme(), extreme(), extreme()}; };
  for (BodyState& state : frame.states)
    state = {vector(), Quat{-0.0, limits::denorm_min(), 1, -limits::denorm_min()}, vector(), vector()};
  frame.time = -0.0;
  frame.energy = {extreme(), extreme(), extreme(), extreme(), extreme(),
                  extreme(), extreme(), extreme(), vector(),  vector()};
  for (JointState& joint : frame.joints) joint = {extreme(), extreme(), extreme()};
  {
    TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader());
    writer.append(frame);
    writer.finish({});
  }
  expectSameBits(TrajectoryReader(folder.file("a.sqlite")).readFrame(0), frame);
}

TEST(TrajectoryFile, GivesEventsBackInOrder) {
  const TemporaryFolder folder;
  writeSample(folder.file("a.sqlite"), 3);
  const std::vector<Event> events = TrajectoryReader(folder.file("a.sqlite")).events();
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].kind, EventKind::impact);
  EXPECT_EQ(events[0].bodyA, 0);
  EXPECT_EQ(events[0].bodyB, 2);
  EXPECT_EQ(events[0].time, 0.1);
  EXPECT_EQ(events[0].point, Vec3(1, 2, 3));
  EXPECT_EQ(events[0].normal, Vec3(0, 1, 0));
  EXPECT_EQ(events[0].impulse, 0.7);
  EXPECT_EQ(events[1].kind, EventKind::taut);
  EXPECT_EQ(events[1].bodyB, -1);
  expectSameBits(events[1].point.x(), -0.0);
  EXPECT_EQ(events[1].point.z(), 0.25);
  EXPECT_EQ(events[1].impulse, 1e99);
}

TEST(TrajectoryFile, KeepsEveryKindOfEvent) {
  const TemporaryFolder folder;
  TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader());
  writer.append(sampleFrame(0));
  for (int kind = 0; kind <= static_cast<int>(EventKind::pushMissed); ++kind)
    writer.append(Event{0, static_cast<EventKind>(kind), 0, -1, Vec3::Zero(), Vec3::Zero(), 0});
  writer.finish({});
  const std::vector<Event> events = TrajectoryReader(folder.file("a.sqlite")).events();
  ASSERT_EQ(events.size(), 12u);
  for (std::size_t i = 0; i < events.size(); ++i) EXPECT_EQ(static_cast<std::size_t>(events[i].kind), i);
}

TEST(TrajectoryFile, KeepsTheCostOfTheRun) {
  const TemporaryFolder folder;
  writeSample(folder.file("a.sqlite"), 1);
  const TrajectoryReader reader(folder.file("a.sqlite"));
  EXPECT_TRUE(reader.isFinished());
  EXPECT_EQ(reader.cost().cpuSeconds, 0.125);
  EXPECT_EQ(reader.cost().evaluations, 12345678901);
}

TEST(TrajectoryFile, RefusesStatesThatAreNotFiniteAndNamesTheBody) {
  const TemporaryFolder folder;
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()};
  for (const double number : bad) {
    TrajectoryWriter writer(folder.file("a.sqlite"), sampleHeader());
    Frame frame = sampleFrame(0);
    frame.states[1].angularVelocity.z() = number;
    expectError(ErrorKind::unstable, "wedge", [&] { writer.append(frame); });
    frame = sampleFrame(0);
    frame.states[1].position.x() = 1e30;
    expectError(ErrorKind::unstable, "wedge", [&] { writer.append(frame); });
    frame = sampleFrame(0);
    frame.states[1].orientation.coeffs() *= 1.01;
    expectError(ErrorKind::unstable, "wedge", [&] { writer.append(frame); });
    frame = sampleFrame(0);
    frame.energy.work = number;
    expectError(ErrorKind::unstable, "energy", [&] { writer.append(frame); });
    frame = sampleFrame(0);
    frame.joints[1].force = number;
    expectError(ErrorKind::unstable, "rail", [&] { writer.append(frame); });
    expectError(ErrorKind::unstable, "slip", [&] {
      writer.append(Event{0, EventKind::slip, 0, -1, Vec3::Zero(), Vec3::Zero(), number});
    });
  }
}

TEST(TrajectoryFile, HoldsScenesWithNothingThatMoves) {
  const TemporaryFolder folder;
  TrajectoryHeader header = sampleHeader();
  header.bodies = {header.bodies[1]};
  header.meshes.clear(), header.joints.clear();
  TrajectoryWriter writer(folder.file("a.sqlite"), header);
  writer.append(Frame{});
  writer.finish({});
  EXPECT_TRUE(TrajectoryReader(folder.file("a.sqlite")).readFrame(0).states.empty());
}

}  // namespace
}  // namespace cradle
