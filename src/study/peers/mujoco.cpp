// MuJoCo 2.2.2 (E. Todorov, T. Erez, Y. Tassa, "MuJoCo: a physics engine for model-based control", IROS 2012).

#include "study/peers/mujoco.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>

#include "core/error.h"
#include "study/peers/mujoco_model.h"
#include "study/peers/peer_shapes.h"

namespace cradle {
namespace {

constexpr const char* kFileName = "scene.xml";  // in memory
constexpr long kStagesOfRungeKutta = 4;

/// MuJoCo's own handlers would end the program, and write a file.
[[noreturn]] void giveUp(const char* what) {
  throw Error(ErrorKind::limit, "", fmt::format("MuJoCo gave up: {}", what));
}
void ignore(const char*) {}

struct FreeModel {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using ModelPointer = std::unique_ptr<mjModel, FreeModel>;

ModelPointer load(const std::string& text) {
  mju_user_error = giveUp;
  mju_user_warning = ignore;
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  CRADLE_CHECK(mj_makeEmptyFileVFS(files.get(), kFileName, static_cast<int>(text.size())) == 0);
  const auto index = static_cast<std::size_t>(mj_findFileVFS(files.get(), kFileName));
  std::copy(text.begin(), text.end(), static_cast<char*>(files->filedata[index]));
  std::array<char, 1000> fault{};
  ModelPointer model(mj_loadXML(kFileName, files.get(), fault.data(), static_cast<int>(fault.size())));
  mj_deleteVFS(files.get());
  if (!model) giveUp(fault.data());
  return model;
}

class MujocoWorld : public SteppedWorld {
 public:
  MujocoWorld(const Scene& scene, const Assembly& assembly, const MujocoSettings& settings, double timeStep);
  void read(VectorX& state) override;

 private:
  void step() override;
  void setVelocity(const TreeLink& link, const Assembly& assembly);
  void leadDriven();
  void placeDriven();

  const Assembly& assembly_;
  ModelPointer model_;
  std::unique_ptr<mjData, FreeModel> data_;
  std::vector<int> bodies_;  // MuJoCo's, in the order of the assembly
};

MujocoWorld::MujocoWorld(const Scene& scene, const Assembly& assembly, const MujocoSettings& settings, double timeStep)
    : SteppedWorld(timeStep, settings.integrator == "RK4" ? kStagesOfRungeKutta : 1), assembly_(assembly) {
  const JointTree tree = jointTreeOf(assembly);
  model_ = load(mujocoModelOf(scene, assembly, tree, settings, timeStep));
  data_.reset(mj_makeData(model_.get()));
  for (std::size_t i = 0; i < assembly.mechanism.bodies.size(); ++i)
    bodies_.push_back(mj_name2id(model_.get(), mjOBJ_BODY, fmt::format("body{}", i).c_str()));
  for (const TreeLink& link : tree.links) setVelocity(link, assembly);
}

/// Velocity, and a motor's force for the whole run.
void MujocoWorld::setVelocity(const TreeLink& link, const Assembly& assembly) {
  const LinkStart start = startOf(link, assembly);
  const int first = model_->body_dofadr[bodies_[static_cast<std::size_t>(link.body)]];
  mjtNum* velocity = link.kind == TreeLink::Kind::weld ? nullptr : data_->qvel + first;
  switch (link.kind) {
    case TreeLink::Kind::free:
      Vec3::Map(velocity) = linearVelocity(assembly.state, link.body);
      Vec3::Map(velocity + 3) = start.relativeSpin;
      break;
    case TreeLink::Kind::ball:
      Vec3::Map(velocity) = start.relativeSpin;
      break;
    case TreeLink::Kind::hinge:
      *velocity = start.relativeSpin.dot(link.axis);
      data_->qfrc_applied[first] = link.motorForce;
      break;
    case TreeLink::Kind::slider:
      *velocity = start.relativeVelocity.dot(link.axis);
      data_->qfrc_applied[first] = link.motorForce;
      break;
    case TreeLink::Kind::weld:
      break;
  }
}

/// Gives driven bodies the force and the torque (moments of inertia are equal) by which their velocities at the end of
/// the step are right.
void MujocoWorld::leadDriven() {
  for (const DrivenBody& driven : assembly_.mechanism.driven) {
    const int body = bodies_[static_cast<std::size_t>(driven.body)];
    const PoseMotion now = motionAt(driven.motion, time()), next = motionAt(driven.motion, endTime());
    const Vec3 acceleration = (next.velocity - now.velocity) / timeStep() - assembly_.mechanism.gravity;
    Vec3::Map(data_->xfrc_applied + 6 * body) = model_->body_mass[body] * acceleration;
    Vec3::Map(data_->xfrc_applied + 6 * body + 3) =
        model_->body_inertia[3 * body] / timeStep() * (next.angularVelocity - now.angularVelocity);
  }
}

/// Sets driven bodies to where they are at the end of the step.
void MujocoWorld::placeDriven() {
  for (const DrivenBody& driven : assembly_.mechanism.driven) {
    const int body = bodies_[static_cast<std::size_t>(driven.body)];
    const PoseMotion now = motionAt(driven.motion, endTime());
    const Quat& turn = now.pose.rotation;
    mjtNum* pose = data_->qpos + model_->jnt_qposadr[model_->body_jntadr[body]];
    Vec3::Map(pose) = now.pose.translation;
    pose[3] = turn.w(), Vec3::Map(pose + 4) = turn.vec();
    mjtNum* velocity = data_->qvel + model_->body_dofadr[body];
    Vec3::Map(velocity) = now.velocity, Vec3::Map(velocity + 3) = turn.conjugate() * now.angularVelocity;
  }
}

void MujocoWorld::step() {
  leadDriven();
  mj_step(model_.get(), data_.get());
  placeDriven();
  const auto hasWarned = [&](mjtWarning kind) { return data_->warning[kind].number > 0; };
  if (hasWarned(mjWARN_BADQPOS) || hasWarned(mjWARN_BADQVEL) || hasWarned(mjWARN_BADQACC))
    throw Error(ErrorKind::unstable, "", fmt::format("MuJoCo found its state bad at {} s", data_->time));
  if (hasWarned(mjWARN_CONTACTFULL) || hasWarned(mjWARN_CNSTRFULL)) giveUp("its lists of contacts are full");
}

void MujocoWorld::read(VectorX& state) {
  mj_kinematics(model_.get(), data_.get());
  mj_comPos(model_.get(), data_.get());
  mj_comVel(model_.get(), data_.get());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Eigen::Index index = static_cast<Eigen::Index>(i);
    const mjtNum *place = data_->xpos + 3 * bodies_[i], *turn = data_->xquat + 4 * bodies_[i];
    std::array<mjtNum, 6> velocity{};  // angular first
    mj_objectVelocity(model_.get(), data_.get(), mjOBJ_BODY, bodies_[i], velocity.data(), 0);
    centerOfMass(state, index) = Vec3::Map(place);
    setOrientation(state, index, Quat(turn[0], turn[1], turn[2], turn[3]));
    linearVelocity(state, index) = Vec3::Map(velocity.data() + 3);
    angularVelocity(state, index) = Vec3::Map(velocity.data());
  }
}

std::string missingInMujoco(const Scene& scene, const Assembly& assembly) {
  if (!scene.ropes.empty()) return "ropes that give back what they take";
  const JointTree tree = jointTreeOf(assembly);
  for (const Constraint& loop : tree.loops)
    if (std::holds_alternative<SliderConstraint>(loop.kind)) return "sliders that close a loop";
  if (const std::string missing = missingMotors(tree, assembly); !missing.empty()) return missing;
  if (const std::string missing = missingInEveryPeer(scene); !missing.empty()) return missing;
  return meshThatTouches(scene);
}

Peer peerOf(const std::string& name, const std::string& title, const MujocoSettings& settings) {
  Peer peer{"mujoco", "2.2.2", name, title, "", SettingKind::timeStep, missingInMujoco, {}};
  peer.configuration =
      fmt::format("integrator {}, Newton solver, {}", settings.integrator,
                  settings.isTuned ? "elliptic cones, impratio 10, solref (2 steps, 1), solimp (0.99, 0.999)"
                                   : "pyramidal cones, solref (0.02 s, 1), solimp (0.9, 0.95)");
  peer.open = [settings](const Scene& scene, const Assembly& assembly, double timeStep) {
    return std::make_unique<MujocoWorld>(scene, assembly, settings, timeStep);
  };
  return peer;
}

}  // namespace

std::vector<Peer> mujocoPeers() {
  return {peerOf("mujoco", "MuJoCo", {}), peerOf("mujocoRk4", "MuJoCo, RK4", {"RK4", false}),
          peerOf("mujocoTuned", "MuJoCo, implicit, stiff", {"implicit", true}),
          peerOf("mujocoRk4Tuned", "MuJoCo, RK4, stiff", {"RK4", true})};
}

}  // namespace cradle
