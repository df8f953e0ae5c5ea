#include "trajectory/state_hash.h"

#include "sample_trajectory.h"

namespace cradle {
namespace {

std::string hashOf(const Frame& frame) {
  Hash hash;
  addFrame(frame, hash);
  return hash.hex();
}

// The published test values of the 64-bit FNV-1a.
TEST(Hash, IsFnv1a) {
  EXPECT_EQ(textHash(""), "cbf29ce484222325");
  EXPECT_EQ(textHash("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(textHash("foobar"), "85944171f73967e8");
}

TEST(StateHash, ChangesWithAnySingleBit) {
  const std::string original = hashOf(sampleFrame(3));
  for (std::size_t place = 0; place < 27; ++place) {
    for (int bit = 0; bit < 64; ++bit) {
      Frame frame = sampleFrame(3);
      BodyState& state = frame.states[place % 2];
      double* const numbers[] = {&state.position[0],        &state.position[1],
                                 &state.position[2],        &state.orientation.w(),
                                 &state.orientation.x(),    &state.orientation.y(),
                                 &state.orientation.z(),    &state.linearVelocity[0],
                                 &state.linearVelocity[1],  &state.linearVelocity[2],
                                 &state.angularVelocity[0], &state.angularVelocity[1],
                                 &state.angularVelocity[2], &frame.time};
      double& number = *numbers[place / 2];
      number = std::bit_cast<double>(std::bit_cast<std::uint64_t>(number) ^ (std::uint64_t{1} << bit));
      EXPECT_NE(hashOf(frame), original) << "number " << place << " bit " << bit;
    }
  }
}

TEST(StateHash, TellsMinusZeroFromZeroAndSwappedBodies) {
  Frame frame = sampleFrame(0);
  frame.states[0].position.x() = 0;
  const std::string zero = hashOf(frame);
  frame.states[0].position.x() = -0.0;
  EXPECT_NE(hashOf(frame), zero);
  std::swap(frame.states[0], frame.states[1]);
  EXPECT_NE(hashOf(frame), zero);
}

// Little-endian bytes, number first: computed here byte by byte from the rule in the documentation.
TEST(StateHash, IsTheHashOfTheDocumentedBytes) {
  const Frame frame = sampleFrame(2);
  std::string bytes("\x02\0\0\0\0\0\0\0", 8);
  const auto add = [&](double number) {
    for (int shift = 0; shift < 64; shift += 8)
      bytes += static_cast<char>(std::bit_cast<std::uint64_t>(number) >> shift & 255);
  };
  add(0.25);
  for (const BodyState& s : frame.states) {
    for (int i = 0; i < 3; ++i) add(s.position[i]);
    for (const double q : {s.orientation.w(), s.orientation.x(), s.orientation.y(), s.orientation.z()}) add(q);
    for (int i = 0; i < 3; ++i) add(s.linearVelocity[i]);
    for (int i = 0; i < 3; ++i) add(s.angularVelocity[i]);
  }
  EXPECT_EQ(hashOf(frame), textHash(bytes));
}

TEST(StateHash, IsTheSameForTheSameRunTwice) {
  const TemporaryFolder folder;
  writeSample(folder.file("a.sqlite"), 7);
  writeSample(folder.file("b.sqlite"), 7);
  writeSample(folder.file("c.sqlite"), 8);
  const std::string hash = TrajectoryReader(folder.file("a.sqlite")).stateHash();
  EXPECT_EQ(hash, TrajectoryReader(folder.file("b.sqlite")).stateHash());
  EXPECT_NE(hash, TrajectoryReader(folder.file("c.sqlite")).stateHash());
}

TEST(StateHash, CanBeComputedAgainFromTheFile) {
  const TemporaryFolder folder;
  writeSample(folder.file("a.sqlite"), 7);
  const TrajectoryReader reader(folder.file("a.sqlite"));
  Hash hash;
  for (long number = 0; number < reader.frameCount(); ++number) addFrame(reader.readFrame(number), hash);
  EXPECT_EQ(hash.hex(), reader.stateHash());
}

}  // namespace
}  // namespace cradle
