#include "trajectory/compare_trajectories.h"

#include <sqlite3.h>

#include "sample_trajectory.h"

namespace cradle {
namespace {

class CompareTrajectories : public testing::Test {
 protected:
  /// A trajectory of `count` sample frames, `framesPerSecond` a second, each changed by `change`.
  TrajectoryReader written(const std::function<void(Frame&)>& change, long count = 5, double framesPerSecond = 8,
                           const TrajectoryHeader& header = sampleHeader()) {
    const std::string path = folder_.file(std::to_string(folder_.count()) + ".sqlite");
    TrajectoryWriter writer(path, header);
    for (long number = 0; number < count; ++number) {
      Frame frame = sampleFrame(number);
      frame.time = static_cast<double>(number) / framesPerSecond;
      change(frame);
      writer.append(frame);
    }
    writer.finish({});
    return TrajectoryReader(path);
  }
  TrajectoryReader unchanged() {
    return written([](Frame&) {});
  }
  static void expectWords(const TrajectoryComparison& result, const std::string& words) {
    EXPECT_NE(result.describe().find(words), std::string::npos) << result.describe();
  }

  TemporaryFolder folder_;
};

TEST_F(CompareTrajectories, SameHashIsEqual) {
  const auto result = compareTrajectories(unchanged(), unchanged(), 0);
  EXPECT_TRUE(result.equal);
  EXPECT_TRUE(result.sameStateHash);
  expectWords(result, "equal");
}

// The hash that a file names is not taken for that of its frames.
TEST_F(CompareTrajectories, FramesThatAreNotThoseOfTheHashAreDamage) {
  const TrajectoryReader expected = unchanged(), actual = unchanged();
  for (const std::string sql :
       {"UPDATE state SET px = px + 1 WHERE frame = 3", "UPDATE frame SET time = 0.51 WHERE id = 4",
        "DELETE FROM state WHERE frame = 4; DELETE FROM energy WHERE frame = 4; "
        "DELETE FROM joint_state WHERE frame = 4; DELETE FROM frame WHERE id = 4"}) {
    const std::string path = folder_.file("changed.sqlite");
    std::filesystem::copy_file(actual.path(), path, std::filesystem::copy_options::overwrite_existing);
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(database);
    const TrajectoryReader changed(path);
    expectError(ErrorKind::usage, "stateHash", [&] { compareTrajectories(expected, changed, 1); });
    expectError(ErrorKind::usage, "stateHash", [&] { compareTrajectories(changed, expected, 1); });
  }
}

TEST_F(CompareTrajectories, FindsAKnownDifference) {
  const auto actual = written([](Frame& frame) {
    if (frame.number == 3) frame.states[1].linearVelocity.y() += 0.01;
    if (frame.number == 2) frame.states[0].position.x() += 0.001;
  });
  const double reference = sampleFrame(3).states[1].linearVelocity.y();
  const double expected = 0.01 / (1 + std::abs(reference));
  const auto result = compareTrajectories(unchanged(), actual, 0);
  EXPECT_FALSE(result.equal);
  EXPECT_EQ(result.commonFrames, 5);
  // The sum x + 0.01 is rounded once.
  EXPECT_NEAR(result.worst.difference, expected, 1e-15);
  EXPECT_EQ(result.worst.body, "wedge");
  EXPECT_EQ(result.worst.quantity, "linear velocity");
  EXPECT_EQ(result.worst.frame, 3);
  EXPECT_EQ(result.worst.time, 0.375);
  ASSERT_EQ(result.bodies.size(), 2u);
  EXPECT_EQ(result.bodies[0].body, "ball");
  EXPECT_NEAR(result.bodies[0].position, 0.001 / (1 + std::abs(sampleFrame(2).states[0].position.x())), 1e-15);
  EXPECT_EQ(result.bodies[0].linearVelocity, 0);
  EXPECT_EQ(result.bodies[1].position, 0);
  EXPECT_NEAR(result.bodies[1].linearVelocity, expected, 1e-15);
  expectWords(result, "linear velocity of wedge in frame 3");
}

TEST_F(CompareTrajectories, DividesByOnePlusTheExpectedSize) {
  const auto reference = written([](Frame& frame) { frame.states[0].angularVelocity.z() = -999; });
  const auto actual = written([](Frame& frame) { frame.states[0].angularVelocity.z() = -998; });
  const auto result = compareTrajectories(reference, actual, 0.001);
  EXPECT_EQ(result.worst.difference, 0.001);
  EXPECT_EQ(result.worst.quantity, "angular velocity");
  EXPECT_TRUE(result.equal) << "a difference of just the tolerance is allowed";
  EXPECT_FALSE(compareTrajectories(reference, actual, std::nextafter(0.001, 0)).equal);
}

TEST_F(CompareTrajectories, TakesQuaternionsOfOppositeSignForEqual) {
  const auto actual = written([](Frame& frame) {
    if (frame.number % 2 == 1) frame.states[0].orientation.coeffs() *= -1;
  });
  const auto result = compareTrajectories(unchanged(), actual, 0);
  EXPECT_FALSE(result.sameStateHash);
  EXPECT_TRUE(result.equal) << result.describe();
}

TEST_F(CompareTrajectories, SeesATurnedBody) {
  const auto reference = written([](Frame& frame) { frame.states[0].orientation = Quat(1, 0, 0, 0); });
  const auto actual = written([](Frame& frame) { frame.states[0].orientation = Quat(-0.6, 0, 0.8, 0); });
  const auto result = compareTrajectories(reference, actual, 0);
  // -q is nearer: |0.6 - 1| / 2 and |-0.8 - 0| / 1.
  EXPECT_EQ(result.bodies[0].orientation, 0.8);
  EXPECT_EQ(result.worst.quantity, "orientation");
}

TEST_F(CompareTrajectories, MissingBodiesAreDifferent) {
  TrajectoryHeader header = sampleHeader();
  header.bodies[2].name = "other";
  const auto actual = written([](Frame& frame) { frame.time += 1e-15; }, 5, 8, header);
  const auto result = compareTrajectories(unchanged(), actual, 1);
  EXPECT_FALSE(result.equal);
  EXPECT_EQ(result.onlyExpected, std::vector<std::string>{"wedge"});
  EXPECT_EQ(result.onlyActual, std::vector<std::string>{"other"});
  ASSERT_EQ(result.bodies.size(), 1u);
  EXPECT_EQ(result.bodies[0].largest(), 0);
  expectWords(result, "only the expected trajectory moves: wedge");
  expectWords(result, "only the actual trajectory moves: other");
}

TEST_F(CompareTrajectories, PairsBodiesByNameAndNotByOrder) {
  TrajectoryHeader header = sampleHeader();
  std::swap(header.bodies[0], header.bodies[2]);
  const auto actual = written([](Frame& frame) { std::swap(frame.states[0], frame.states[1]); }, 5, 8, header);
  const auto result = compareTrajectories(unchanged(), actual, 0);
  EXPECT_FALSE(result.sameStateHash);
  EXPECT_TRUE(result.equal) << result.describe();
}

TEST_F(CompareTrajectories, PairsFramesByTime) {
  // Twice as many frames a second: every second one is common.
  const auto reference = written([](Frame& frame) { frame.states = sampleFrame(2 * frame.number).states; }, 4, 30);
  const auto actual = written([](Frame&) {}, 20, 60);
  const auto result = compareTrajectories(reference, actual, 0);
  EXPECT_EQ(result.commonFrames, 4);
  EXPECT_TRUE(result.equal) << result.describe();
  expectWords(result, "4 frames in common (expected has 4, actual 20)");
}

TEST_F(CompareTrajectories, NoCommonFrameIsDifferent) {
  const auto actual = written([](Frame& frame) { frame.time += 0.01; });
  const auto result = compareTrajectories(unchanged(), actual, 1);
  EXPECT_EQ(result.commonFrames, 0);
  EXPECT_FALSE(result.equal);
}

TEST_F(CompareTrajectories, UnfinishedRunsAreComparedByTheirFrames) {
  std::string kept;
  {
    TrajectoryWriter writer(folder_.file("x.sqlite"), sampleHeader());
    for (long number = 0; number < 2; ++number) writer.append(sampleFrame(number));
    kept = writer.keptPath();
  }
  const TrajectoryReader part(kept);
  const auto result = compareTrajectories(part, part, 0);
  EXPECT_FALSE(result.sameStateHash);
  EXPECT_TRUE(result.equal);
  EXPECT_EQ(compareTrajectories(part, unchanged(), 0).commonFrames, 2);
}

TEST_F(CompareTrajectories, ListsAtMostTenBodies) {
  TrajectoryHeader header = sampleHeader();
  header.bodies.assign(30, header.bodies[0]);
  for (std::size_t i = 0; i < 30; ++i) header.bodies[i].name = "body_" + std::to_string(i);
  const auto actual = written([](Frame& frame) { frame.states.resize(30); }, 1, 8, header);
  expectWords(compareTrajectories(unchanged(), actual, 0), "body_9 and 20 more");
}

}  // namespace
}  // namespace cradle
