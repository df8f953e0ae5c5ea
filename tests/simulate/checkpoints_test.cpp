#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "experiments/experiment.h"
#include "scene/load_scene.h"
#include "simulate/assembly.h"
#include "simulate/run_record.h"
#include "simulate/simulate.h"
#include "simulate/world.h"
#include "trajectory/state_hash.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

/// What a run tells, from a record on or from the start.
struct Told {
  std::vector<Frame> frames;
  std::vector<Event> events;
  std::vector<LastingContact> contacts;
  std::vector<std::string> warnings;
  std::vector<Checkpoint> checkpoints;
  std::vector<std::size_t> eventsBy;  // of each checkpoint
  RunCost cost;
};

Told tell(const Scene& scene, long checkpointWork, const std::string& record = "") {
  Told told;
  World run(scene);
  SimulationSink sink{[&](const Frame& frame) { told.frames.push_back(frame); },
                      [&](const Event& event) { told.events.push_back(event); },
                      [&](const std::string& warning) { told.warnings.push_back(warning); }};
  sink.contact = [&](const LastingContact& contact) { told.contacts.push_back(contact); };
  sink.checkpoint = [&](const Checkpoint& checkpoint) {
    told.checkpoints.push_back(checkpoint);
    told.eventsBy.push_back(told.events.size());
  };
  told.cost = simulate(scene, run, sink, record, checkpointWork);
  return told;
}

std::string hashOf(const std::vector<Frame>& frames, long from) {
  Hash hash;
  for (const Frame& frame : frames)
    if (frame.number > from) addFrame(frame, hash);
  return hash.hex();
}

bool areSame(const Event& a, const Event& b) {
  return a.time == b.time && a.kind == b.kind && a.bodyA == b.bodyA && a.bodyB == b.bodyB && a.point == b.point &&
         a.impulse == b.impulse;
}

bool areSame(const ContactWrench& a, const ContactWrench& b) {
  return a.contact == b.contact && a.bodyA == b.bodyA && a.bodyB == b.bodyB && a.force == b.force &&
         a.torque == b.torque && a.point == b.point;
}

/// All that a run tells behind a checkpoint is what one tells that goes on from there.
void expectSameBehind(const Told& whole, std::size_t index, const Told& rest) {
  const Checkpoint& checkpoint = whole.checkpoints[index];
  EXPECT_EQ(hashOf(rest.frames, checkpoint.frame), hashOf(whole.frames, checkpoint.frame));
  ASSERT_EQ(rest.events.size(), whole.events.size() - whole.eventsBy[index]);
  for (std::size_t i = 0; i < rest.events.size(); ++i)
    EXPECT_TRUE(areSame(rest.events[i], whole.events[whole.eventsBy[index] + i])) << "event " << i;
  for (const Frame& frame : rest.frames) {
    const Frame& other = whole.frames[static_cast<std::size_t>(frame.number)];
    EXPECT_EQ(frame.energy.numerical, other.energy.numerical);
    EXPECT_EQ(frame.energy.dissipated, other.energy.dissipated);
    ASSERT_TRUE(std::equal(frame.contacts.begin(), frame.contacts.end(), other.contacts.begin(), other.contacts.end(),
                           [](const ContactWrench& a, const ContactWrench& b) { return areSame(a, b); }))
        << "frame " << frame.number;
    for (std::size_t i = 0; i < frame.joints.size(); ++i)
      EXPECT_EQ(frame.joints[i].coordinate, other.joints[i].coordinate);
  }
  EXPECT_EQ(rest.cost.evaluations, whole.cost.evaluations);
  EXPECT_EQ(rest.cost.corrections, whole.cost.corrections);
  EXPECT_EQ(rest.cost.promise, whole.cost.promise);
}

std::vector<std::string> sceneNames() {
  std::vector<std::string> names;
  for (const auto& file : fs::directory_iterator(fs::path(CRADLE_SOURCE_DIR) / "scenes"))
    if (file.path().extension() == ".json") names.push_back(file.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

class CheckpointsOf : public testing::TestWithParam<std::string> {};

/// s: of those that cost much, the beginning.
double durationOf(const std::string& name, double duration) {
  const bool isSlow = name == "arch" || name == "dominoes" || name == "platform_drop" || name == "gears_on_platform" ||
                      name == "rope_bridge" || name == "chains_that_throw" || name == "gears_fall";
  const bool hasHeap = name.ends_with("_tray") || name == "avalanche";
  return std::min(duration, hasHeap ? 0.1 : isSlow ? 0.4 : 1.2);
}

// A run that is thrown away at each of its checkpoints, and one that goes on from a record alone, have the same bits.
TEST_P(CheckpointsOf, AScene) {
  Scene scene = loadScene((fs::path(CRADLE_SOURCE_DIR) / "scenes" / (GetParam() + ".json")).string()).scene;
  scene.duration = durationOf(GetParam(), scene.duration);
  refuseUnsupported(scene);
  World plain(scene);
  simulate(scene, plain, {[](const Frame&) {}, [](const Event&) {}, [](const std::string&) {}});
  const Told whole = tell(scene, std::max(1L, plain.work() / 5));
  for (std::size_t i = 0; i < whole.checkpoints.size(); ++i)
    expectSameBehind(whole, i, tell(scene, std::max(1L, plain.work() / 5), whole.checkpoints[i].record));
}

/// A member of a record, how it is lost, and a scene that shows it.
struct Loss {
  std::string name, scene;
  std::function<void(RunRecord&)> lose;
};

template <class Lose>
auto ofIslands(const Lose& lose) {
  return [lose](RunRecord& run) {
    for (IslandRecord& island : run.world.islands) lose(island);
    for (GroupRecord& group : run.world.groups) lose(group.island);
  };
}

template <class Lose>
auto ofSoftIslands(const Lose& lose) {
  return [lose](RunRecord& run) {
    for (SoftSubsteps::Record& heap : run.world.softIslands) lose(heap);
  };
}

template <class Lose>
auto ofParts(const Lose& lose) {
  return ofIslands([lose](IslandRecord& island) {
    for (PartRecord& part : island.parts) lose(part);
  });
}

/// Half of the boxes sleep when they are struck.
const std::string kHeap = R"("accuracy": "visual", "duration": 3, "bodies": [
    {"name": "floor", "shape": {"plane": {}}, "motion": "static"},
    {"name": "box", "shape": {"box": {"size": [0.2, 0.2, 0.2]}}, "position": [0, 0.1, 0],
     "copies": {"count": [6, 4, 6], "spacing": [0.21, 0.2, 0.21]}},
    {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "position": [0.4, 14, 0.4],
     "copies": {"count": [3, 1, 3], "spacing": [0.3, 0.3, 0.3]}}])";

/// Three balls in a row between two walls, of which one has this speed (m/s) along the row.
std::string gas(int speed) {
  return R"("gravity": [0, 0, 0], "duration": 4, "materials": {"hard": {"restitution": 1,
    "staticFriction": 0, "dynamicFriction": 0}}, "bodies": [
    {"name": "left", "shape": {"plane": {"normal": [1, 0, 0]}}, "motion": "static", "material": "hard", "position": [-1, 0, 0]},
    {"name": "right", "shape": {"plane": {"normal": [-1, 0, 0]}}, "motion": "static", "material": "hard", "position": [1, 0, 0]},
    {"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "material": "hard", "position": [-0.8, 0, 0],
     "copies": {"count": [3, 1, 1], "spacing": [0.3, 0.0, 0.0]}, "linearVelocity": [)" +
         std::to_string(speed) + ", 0.001, 0]}]";
}

std::vector<Loss> losses() {
  const std::string ball = R"({"name": "ball", "shape": {"sphere": {"radius": 0.1}}, "position": [0, 1, 0])";
  const std::string floor = R"({"name": "floor", "shape": {"plane": {}}, "motion": "static"})";
  const std::string springy = R"("duration": 2, "bodies": [)" + ball +
                              R"(}], "springs": [{"bodyA": "ball", "anchorB": [1, 1, 0], "stiffness": 90}])";
  const std::string bouncing =
      R"("duration": 3, "materials": {"rubber": {"restitution": 0.9}}, "bodies": [{"name": "floor", "shape": {"plane": {}},
      "motion": "static", "material": "rubber"}, )" +
      ball + R"(, "material": "rubber"}])";
  const std::string turning = R"("duration": 3, "bodies": [{"name": "arm", "shape": {"box": {"size": [1, 0.1, 0.1]}},
      "angularVelocity": [0, 0, 9]}], "hinges": [{"name": "axle", "bodyA": "arm", "anchorB": [0, 0, 0], "axis": [0, 0, 1]}])";
  const std::string flying = R"("duration": 2, "bodies": [)" + ball + R"(, "linearVelocity": [3, 0, 0]},
      {"name": "other", "shape": {"sphere": {"radius": 0.1}}, "position": [0, 2, 0]}],
      "springs": [{"bodyA": "ball", "bodyB": "other", "stiffness": 90, "restLength": 0.5}])";
  // Two stacks of boxes, of which one is struck late; a third falls over all the time.
  const std::string resting = R"("duration": 2, "bodies": [)" + floor + R"(,
      {"name": "a", "shape": {"box": {"size": [0.2, 0.2, 0.2]}}, "position": [0, 0.1, 0]},
      {"name": "b", "shape": {"box": {"size": [0.2, 0.2, 0.2]}}, "position": [0, 0.3, 0]},
      {"name": "bob", "shape": {"sphere": {"radius": 0.1}}, "position": [6, 3, 0]}],
      "rods": [{"bodyA": "bob", "anchorB": [5, 3, 0]}])";
  const std::string push =
      R"(, "pushes": [{"body": "ball", "start": 0.1, "duration": 1.8, "force": [30, 0, 0], "point": [0, 1.05, 0]}])";
  const std::string euler = methodText("explicitEuler", 0.01) + R"(, "duration": 4, "bodies": [)" + ball +
                            R"(}], "rods": [{"bodyA": "ball", "anchorB": [1, 1, 0]}])";
  return {
      {"spheres' flights", gas(3),
       [](RunRecord& run) {
         for (HardSpheres::Record& spheres : run.world.spheres) spheres.flights.front().since -= 0.01;
       }},
      {"spheres' clock", gas(30),
       [](RunRecord& run) {
         for (HardSpheres::Record& spheres : run.world.spheres) spheres.origin = spheres.originRest = 0;
       }},
      {"heaps' sleep", kHeap, ofSoftIslands([](SoftSubsteps::Record& heap) {
         heap.step.sleep.isAsleep.assign(heap.step.sleep.isAsleep.size(), 0);
       })},
      {"heaps' still times", kHeap, ofSoftIslands([](SoftSubsteps::Record& heap) {
         heap.step.sleep.stillTimes.assign(heap.step.sleep.stillTimes.size(), 0.0);
       })},
      {"heaps' contacts", kHeap, ofSoftIslands([](SoftSubsteps::Record& heap) { heap.step.contacts.clear(); })},
      {"heaps' forces", kHeap, ofSoftIslands([](SoftSubsteps::Record& heap) {
         for (SoftContacts::Record& contact : heap.step.contacts) contact.manifold.forces.fill(0);
       })},
      {"heaps' disturbance", kHeap,
       ofSoftIslands([](SoftSubsteps::Record& heap) { heap.step.isDisturbed = !heap.step.isDisturbed; })},
      {"heaps' loads at rest", kHeap, ofSoftIslands([](SoftSubsteps::Record& heap) { heap.atRest.clear(); })},
      {"ledger", bouncing, ofIslands([](IslandRecord& island) { island.state.tail<kLedgerSize>().setZero(); })},
      {"joints", turning,
       ofIslands([](IslandRecord& island) { island.joints.assign(island.joints.size(), JointState{}); })},
      {"measures", flying, ofIslands([](IslandRecord& island) { island.measures = {}; })},
      {"pushes", springy + push, ofParts([](PartRecord& part) { part.pushes.clear(); })},
      {"resting", resting, ofParts([](PartRecord& part) { part.history.resting = {}; })},
      {"bumps", R"("bumps": {"deviationDegrees": 5}, )" + bouncing,
       ofParts([](PartRecord& part) { part.history.bumps.clear(); })},
      {"evaluations", springy, [](RunRecord& run) { run.world.evaluations = 0; }},
      {"warnings", euler, [](RunRecord& run) { run.warnings = {"another"}; }},
      {"contacts", resting, [](RunRecord& run) { run.contacts = {}; }},
      {"energies", euler, [](RunRecord& run) { run.energies = {}; }},
  };
}

bool tellsTheSame(const Told& a, const Told& b) {
  const auto areSameFrames = [](const Frame& x, const Frame& y) {
    return x.energy.numerical == y.energy.numerical && x.energy.impact == y.energy.impact &&
           std::equal(x.contacts.begin(), x.contacts.end(), y.contacts.begin(), y.contacts.end(),
                      [](const ContactWrench& c, const ContactWrench& d) { return areSame(c, d); }) &&
           std::equal(x.joints.begin(), x.joints.end(), y.joints.begin(), y.joints.end(),
                      [](const JointState& c, const JointState& d) { return c.coordinate == d.coordinate; });
  };
  return hashOf(a.frames, 0) == hashOf(b.frames, 0) && a.warnings == b.warnings &&
         std::equal(a.frames.begin(), a.frames.end(), b.frames.begin(), b.frames.end(), areSameFrames) &&
         std::equal(a.events.begin(), a.events.end(), b.events.begin(), b.events.end(),
                    [](const Event& c, const Event& d) { return areSame(c, d); }) &&
         a.contacts.size() == b.contacts.size() && a.cost.evaluations == b.cost.evaluations &&
         a.cost.promise == b.cost.promise;
}

// A run that goes on from a record which lacks something tells another story than one that goes on from the whole.
TEST(Checkpoints, HaveNoMemberThatIsNotNeeded) {
  struct Whole {
    long work = 0;
    std::vector<Checkpoint> checkpoints;
    std::vector<Told> goneOn;  // from each
  };
  std::map<std::string, Whole> known;  // many scenes show several losses
  for (const Loss& loss : losses()) {
    const Scene scene = sceneWith(loss.scene);
    Whole& whole = known[loss.scene];
    if (whole.work == 0) {
      World plain(scene);
      simulate(scene, plain, {[](const Frame&) {}, [](const Event&) {}, [](const std::string&) {}});
      whole.work = std::max(1L, plain.work() / 4);
      whole.checkpoints = tell(scene, whole.work).checkpoints;
    }
    bool isSeen = false;
    for (std::size_t i = 0; i < whole.checkpoints.size() && !isSeen; ++i) {
      const std::string& record = whole.checkpoints[i].record;
      if (i == whole.goneOn.size()) whole.goneOn.push_back(tell(scene, whole.work, record));
      RunRecord lacking = runRecordOf(record);
      loss.lose(lacking);
      isSeen = !tellsTheSame(tell(scene, whole.work, bytesOf(lacking)), whole.goneOn[i]);
    }
    EXPECT_TRUE(isSeen) << loss.name << " is lost at one of " << whole.checkpoints.size();
  }
}

/// m: between the bodies of two runs, at most.
double largestDistance(const Told& a, const Told& b) {
  double largest = 0;
  for (std::size_t frame = 0; frame < a.frames.size(); ++frame)
    for (std::size_t body = 0; body < a.frames[frame].states.size(); ++body)
      largest =
          std::max(largest, (a.frames[frame].states[body].position - b.frames[frame].states[body].position).norm());
  return largest;
}

// A step that ends at a checkpoint is one of the method's own, with an error below the accuracy; four of them, carried
// through one or two seconds of these motions, stay below 100 times that. Steps of one length are cut by rounding alone
// where frames lie at their ends.
TEST(Checkpoints, LeaveMotionsAsTheyAre) {
  constexpr long kNever = 1'000'000'000'000;
  const auto expectNear = [](Scene scene, double most, const std::string& name) {
    scene.duration = std::min(scene.duration, 2.0);
    World plain(scene);
    simulate(scene, plain, {[](const Frame&) {}, [](const Event&) {}, [](const std::string&) {}});
    const Told whole = tell(scene, std::max(1L, plain.work() / 5));
    EXPECT_GE(whole.checkpoints.size(), 2) << name;
    EXPECT_LT(largestDistance(whole, tell(scene, kNever)), most) << name;
    EXPECT_LT(whole.cost.evaluations, 2 * plain.evaluations()) << name;
    EXPECT_GT(2 * whole.cost.evaluations, plain.evaluations()) << name;
  };
  for (const std::string name :
       {"newtons_cradle", "coupled_pendulums", "four_bar", "top_on_ground", "slack_rope", "double_pendulum"}) {
    const Scene scene = loadScene((fs::path(CRADLE_SOURCE_DIR) / "scenes" / (name + ".json")).string()).scene;
    expectNear(scene, 100 * scene.accuracy, name);
  }
  for (const std::string name : {"rk4", "explicitEuler", "semiImplicitEuler"})
    expectNear(sceneWith(methodText(name, 1.0 / 960) + R"(, "duration": 2, "bodies": [{"name": "ball",
      "shape": {"sphere": {"radius": 0.1}}, "position": [0.3, 0, 0]}], "springs": [{"bodyA": "ball", "anchorB": [0, 1, 0],
      "stiffness": 90}])"),
               1e-9, name);
}

// Elastic balls go on along their parabolas, and what they will meet is found anew: to rounding, which 20 collisions in
// a row make no more than 1e6 times larger. A heap goes on from all that its steps hand on, but sleepers, whose
// contacts stand where the last sub-steps began, are placed where they are: some 1e-5 m away, and 0.5 % of a box in the
// end. It sleeps when it is struck, in the middle of the run.
TEST(Checkpoints, OfHeapsAndOfElasticBallsLeaveMotionsAsTheyAre) {
  const std::array texts = {kHeap, gas(3)};
  for (const std::string& text : texts) {
    const Scene scene = sceneWith(text);
    World plain(scene);
    simulate(scene, plain, {[](const Frame&) {}, [](const Event&) {}, [](const std::string&) {}});
    const Told whole = tell(scene, std::max(1L, plain.work() / 12));
    EXPECT_GE(whole.checkpoints.size(), 5);
    const Told never = tell(scene, 1'000'000'000'000);
    EXPECT_LT(largestDistance(whole, never), &text == &texts[0] ? 1e-3 : 1e-9);
    EXPECT_EQ(whole.cost.evaluations, never.cost.evaluations);
    for (std::size_t i = 0; i < whole.checkpoints.size(); ++i)
      expectSameBehind(whole, i, tell(scene, std::max(1L, plain.work() / 12), whole.checkpoints[i].record));
  }
}

TEST(Checkpoints, ThatAreDamagedAreRefused) {
  std::string bytes = bytesOf(RunRecord{});
  EXPECT_NO_THROW(runRecordOf(bytes));
  for (const std::size_t at : {std::size_t(0), bytes.size() / 2, bytes.size() - 1}) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    EXPECT_THROW(runRecordOf(damaged), Error);
  }
  EXPECT_THROW(runRecordOf(bytes.substr(0, bytes.size() - 1)), Error);
  EXPECT_THROW(runRecordOf(""), Error);
}

INSTANTIATE_TEST_SUITE_P(All, CheckpointsOf, testing::ValuesIn(sceneNames()),
                         [](const auto& name) { return name.param; });

}  // namespace
}  // namespace cradle
