#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include "core/error.h"
#include "trajectory/trajectory_file.h"

// A small trajectory with everything that the file can hold, and a folder that goes with the test.

namespace cradle {

/// A folder of its own for a test.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "cradle_XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string file(const std::string& name) const { return path_ + "/" + name; }
  const std::string& path() const { return path_; }
  /// How many entries there are.
  long count() const {
    return std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator());
  }

 private:
  std::string path_;
};

inline Model sampleModel() {
  Model model;
  model.name = "models/wedge.3ds#Wedge \"1\"@0.01";
  // A tetrahedron; corners are not shared, so that welding has something to do.
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1.0 / 3, 0), d(0, 0, -1e-7);
  model.drawn.vertices = {a, b, c, a, d, b, b, d, c, c, d, a};
  for (int i = 0; i < 12; ++i) model.drawn.normals.push_back(Vec3f(0.1f * static_cast<float>(i), -1, 0).normalized());
  model.drawn.triangles = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {9, 10, 11}};
  model.drawn.materials = {{"brass, \"old\" \\ \n", Vec3f(1, 0, 128.0f / 255), 0, 3}, {"", Vec3f(0, 1, 0), 3, 1}};
  model.solid = weld(model.drawn.vertices, model.drawn.triangles);
  return model;
}

/// Bodies 0 and 2 are dynamic, body 1 is static; a hinge between those, and a slider of body 2 against the world.
inline TrajectoryHeader sampleHeader() {
  TrajectoryHeader header;
  header.scene = "{\"schema\": \"cradle-scene/1\"} // \xc3\xa9";
  header.scenePath = "scenes/sample.json";
  header.version = "9.8.7";
  header.plan = "one island: events";
  header.accuracy = "1e-6";
  header.method = "dop853";
  header.meshes = {sampleModel()};
  Mat3 inertia;
  inertia << 1.1, -0.1, 0.2, -0.1, 1.2, -0.3, 0.2, -0.3, 1.3;
  header.bodies = {{"ball", true, false, -1, R"({"sphere": {"radius": 1}})", {2.5, Vec3(0.1, -0.2, 0.3), inertia}},
                   {"ground", false, false, -1, R"({"plane": {"normal": [0, 1, 0]}})", {}},
                   {"wedge", true, false, 0, "", {1.0 / 3, Vec3(-0.0, 1e-300, 7), 3 * inertia}}};
  header.joints = {{"lid, \"old\"", "hinge", 0, 2}, {"rail", "slider", 2, -1}};
  return header;
}

/// Frame `number` at number / 8 s; every number in it is different and none is exact in decimals.
inline Frame sampleFrame(long number) {
  auto value = [&, count = 0]() mutable { return std::sin(1.0 + 100.0 * static_cast<double>(number) + ++count); };
  const auto vector = [&] { return Vec3(value(), value(), value()); };
  Frame frame;
  frame.number = number;
  frame.time = static_cast<double>(number) / 8;
  for (int body = 0; body < 2; ++body) {
    BodyState state;
    state.position = vector();
    state.orientation = Quat(value(), value(), value(), value()).normalized();
    state.linearVelocity = vector();
    state.angularVelocity = vector();
    frame.states.push_back(state);
  }
  frame.energy = {value(), value(), value(), value(), value(), value(), value(), value(), vector(), vector()};
  for (int joint = 0; joint < 2; ++joint) frame.joints.push_back({100 * value(), value(), value()});
  return frame;
}

/// Writes frames 0..frames-1 and finishes.
inline void writeSample(const std::string& path, long frames, const TrajectoryHeader& header = sampleHeader()) {
  TrajectoryWriter writer(path, header);
  for (long number = 0; number < frames; ++number) writer.append(sampleFrame(number));
  writer.append(Event{0.1, EventKind::impact, 0, 2, Vec3(1, 2, 3), Vec3(0, 1, 0), 0.7});
  writer.append(Event{0.2, EventKind::taut, 2, -1, Vec3(-0.0, 0, 0.25), Vec3(0, 0, 1), 1e99});
  writer.finish({0.125, 12345678901, {{"clampedEnergy", 2}, {"unsolvedContacts", 1}}});
}

inline void expectSameBits(double a, double b) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b)) << a << " and " << b;
}

inline void expectSameBits(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.number, b.number);
  expectSameBits(a.time, b.time);
  ASSERT_EQ(a.states.size(), b.states.size());
  for (std::size_t body = 0; body < a.states.size(); ++body) {
    const auto numbersOfA = stateNumbers(a.states[body]), numbersOfB = stateNumbers(b.states[body]);
    for (std::size_t i = 0; i < numbersOfA.size(); ++i) expectSameBits(numbersOfA[i], numbersOfB[i]);
  }
  ASSERT_EQ(a.joints.size(), b.joints.size());
  for (std::size_t joint = 0; joint < a.joints.size(); ++joint) {
    expectSameBits(a.joints[joint].coordinate, b.joints[joint].coordinate);
    expectSameBits(a.joints[joint].velocity, b.joints[joint].velocity);
    expectSameBits(a.joints[joint].force, b.joints[joint].force);
  }
  expectSameBits(a.energy.kinetic, b.energy.kinetic);
  expectSameBits(a.energy.potential, b.energy.potential);
  expectSameBits(a.energy.dissipated, b.energy.dissipated);
  expectSameBits(a.energy.work, b.energy.work);
  expectSameBits(a.energy.impact, b.energy.impact);
  expectSameBits(a.energy.friction, b.energy.friction);
  expectSameBits(a.energy.damping, b.energy.damping);
  expectSameBits(a.energy.numerical, b.energy.numerical);
  for (int i = 0; i < 3; ++i) {
    expectSameBits(a.energy.momentum[i], b.energy.momentum[i]);
    expectSameBits(a.energy.angularMomentum[i], b.energy.angularMomentum[i]);
  }
}

/// Expects that all frames there are, are the sample's.
inline void expectFirstFrames(const TrajectoryReader& reader) {
  for (long number = 0; number < reader.frameCount(); ++number)
    expectSameBits(reader.readFrame(number), sampleFrame(number));
}

inline std::string contentOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline void writeContent(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

/// Expects that `action` throws an Error of `kind` whose message has `words` in it.
inline void expectError(ErrorKind kind, const std::string& words, const std::function<void()>& action) {
  try {
    action();
    ADD_FAILURE() << "nothing was thrown, expected: " << words;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

/// Reads all that a trajectory holds, in the way of its users.
inline void readAll(const std::string& path) {
  const TrajectoryReader reader(path);
  for (long number = 0; number < reader.frameCount(); ++number) reader.readFrame(number);
  for (long number = 0; number < reader.frameCount(); ++number) reader.contactsAt(number);
  reader.contacts(), reader.cameras();
  reader.events();
  reader.cost();
}

}  // namespace cradle
