#include "ode_pile.h"

#include <algorithm>
#include <array>

#include "pile_worlds.h"

namespace cradle {
namespace {

constexpr int kMaxContacts = 8;  // of a pair: those of a face on a face
constexpr double kFromYToZ[4] = {0.70710678118654752, -0.70710678118654752, 0, 0};  // capsules: along y, ours

dGeomID geomOf(const PileItem& item) {
  const Vec3 size = 2 * item.halfSize;
  if (item.isBox()) return dCreateBox(nullptr, size.x(), size.y(), size.z());
  return size.isZero() ? dCreateSphere(nullptr, item.radius) : dCreateCapsule(nullptr, item.radius, size.y());
}

dMass massOf(const PileItem& item) {
  dMass mass;
  const Vec3 size = 2 * item.halfSize;
  constexpr int kAlongY = 2;
  if (item.isBox())
    dMassSetBoxTotal(&mass, item.mass, size.x(), size.y(), size.z());
  else if (size.isZero())
    dMassSetSphereTotal(&mass, item.mass, item.radius);
  else
    dMassSetCapsuleTotal(&mass, item.mass, kAlongY, item.radius, size.y());
  return mass;
}

}  // namespace

OdePile::OdePile(const PileScene& scene) {
  dInitODE2(0);
  dAllocateODEDataForThread(static_cast<unsigned>(dAllocateMaskAll));
  dSetMessageHandler([](int, const char*, va_list) {});
  dRandSetSeed(0);
  world_ = dWorldCreate();
  space_ = dHashSpaceCreate(nullptr);
  contacts_ = dJointGroupCreate(0);
  dWorldSetGravity(world_, 0, -9.81, 0);
  dWorldSetAutoDisableFlag(world_, 1);
  for (const PileItem& item : scene.items) add(item);
  for (const PlaneCollider& plane : scene.planes) {
    const Vec3& n = plane.normal;
    dCreatePlane(space_, n.x(), n.y(), n.z(), n.dot(plane.point));
  }
}

OdePile::~OdePile() {
  dJointGroupDestroy(contacts_);
  dSpaceDestroy(space_);
  dWorldDestroy(world_);
}

void OdePile::add(const PileItem& item) {
  const dBodyID body = dBodyCreate(world_);
  const dMass mass = massOf(item);
  dBodySetMass(body, &mass);
  const Quat& turn = item.turn;
  const dReal quaternion[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
  dBodySetPosition(body, item.position.x(), item.position.y(), item.position.z());
  dBodySetQuaternion(body, quaternion);
  dBodySetLinearVel(body, item.velocity.x(), item.velocity.y(), item.velocity.z());
  const dGeomID geom = geomOf(item);
  dGeomSetBody(geom, body);
  if (!item.isBox() && !item.halfSize.isZero()) dGeomSetOffsetQuaternion(geom, kFromYToZ);
  dSpaceAdd(space_, geom);
  bodies_.push_back(body);
}

void OdePile::addContacts(dGeomID a, dGeomID b) {
  const dBodyID bodyA = dGeomGetBody(a), bodyB = dGeomGetBody(b);
  const auto isAwake = [](dBodyID body) { return body != nullptr && dBodyIsEnabled(body) != 0; };
  if (!isAwake(bodyA) && !isAwake(bodyB)) return;
  std::array<dContactGeom, kMaxContacts> found;
  const int count = dCollide(a, b, kMaxContacts, found.data(), sizeof(dContactGeom));
  for (int i = 0; i < count; ++i) {
    dContact contact{};
    contact.surface.mode = dContactApprox1;
    contact.surface.mu = kPileFriction;
    contact.geom = found[static_cast<std::size_t>(i)];
    dJointAttach(dJointCreateContact(world_, contacts_, &contact), bodyA, bodyB);
  }
}

void OdePile::advance() {
  dSpaceCollide(space_, this, [](void* self, dGeomID a, dGeomID b) { static_cast<OdePile*>(self)->addContacts(a, b); });
  dWorldQuickStep(world_, kSoftTimeStep);
  dJointGroupEmpty(contacts_);
}

bool OdePile::isAtRest() const {
  return std::none_of(bodies_.begin(), bodies_.end(), [](dBodyID body) { return dBodyIsEnabled(body) != 0; });
}

PilePoses OdePile::poses() const {
  PilePoses poses;
  for (const dBodyID body : bodies_) {
    const dReal* q = dBodyGetQuaternion(body);
    poses.positions.emplace_back(Vec3::Map(dBodyGetPosition(body)));
    poses.turns.push_back(Quat(q[0], q[1], q[2], q[3]).toRotationMatrix());
  }
  return poses;
}

}  // namespace cradle
