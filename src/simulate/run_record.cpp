#include "simulate/run_record.h"

#include <algorithm>

#include "core/byte_archive.h"
#include "trajectory/state_hash.h"

namespace cradle {
namespace {

constexpr std::size_t kHashDigits = 16;

}  // namespace

template <class Archive>
void visit(Archive& archive, Visited<Archive, Vec3>& vector) {
  archive(vector.x(), vector.y(), vector.z());
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, VectorX>& vector) {
  std::vector<double> numbers(vector.begin(), vector.end());
  archive(numbers);
  if constexpr (Archive::kReads)
    vector = Eigen::Map<const VectorX>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, Invariants>& sums) {
  archive(sums.kinetic, sums.potential, sums.momentum, sums.angularMomentum);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, ConservationRecord::Measures::Dissipation>& by) {
  archive(by.taken, by.given);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, ConservationRecord::Measures>& measures) {
  archive(measures.startTime, measures.start, measures.startSpin, measures.largestEnergy, measures.largestMomentum,
          measures.largestSpin, measures.byImpact, measures.byFriction, measures.byDamping, measures.energy,
          measures.momentum, measures.spin);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, PromiseEnd>& end) {
  archive(end.time, end.reason, end.bodies, end.warning);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, Contact>& contact) {
  archive(contact.pair, contact.bodyA, contact.bodyB, contact.point, contact.normal, contact.separation,
          contact.radiusA, contact.radiusB, contact.lineA, contact.lineB, contact.feature, contact.rimAxis);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, ColliderPair>& pair) {
  archive(pair.a, pair.b, pair.againstPlane, pair.material.restitution, pair.material.staticFriction,
          pair.material.dynamicFriction);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, SupportForce>& support) {
  archive(support.contact, support.pair, support.force);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, RestingBodies::Record>& resting) {
  archive(resting.islands, resting.wakeTimes, resting.supports);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, IslandHistory>& history) {
  archive(history.promiseEnd, history.hasLeftEvents, history.isInContactSteps, history.bumps, history.resting);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, StartedPush>& push) {
  archive(push.push, push.point);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, JointState>& joint) {
  archive(joint.coordinate, joint.velocity, joint.force);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, PartRecord>& part) {
  archive(part.clusters, part.pushes, part.history);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, IslandRecord>& island) {
  archive(island.state, island.joints, island.parts, island.measures);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, GroupRecord>& group) {
  archive(group.island, group.origins, group.together, group.promiseEnd, group.stretch);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, Eigen::Vector3f>& vector) {
  archive(vector.x(), vector.y(), vector.z());
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, PersistentManifold>& manifold) {
  archive(manifold.count, manifold.normalOnA, manifold.onA, manifold.onB, manifold.normal, manifold.separations,
          manifold.forces, manifold.frictionForce, manifold.twist, manifold.friction);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, SoftContacts::Record>& contact) {
  archive(contact.a, contact.b, contact.isAgainstPlane, contact.approach, contact.offset, contact.turned,
          contact.manifold);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, SoftSleep::Record>& sleep) {
  archive(sleep.isAsleep, sleep.stillTimes);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, SoftStep::Record>& step) {
  archive(step.sleep, step.contacts, step.isDisturbed);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, ContactWrench>& wrench) {
  archive(wrench.contact, wrench.bodyA, wrench.bodyB, wrench.force, wrench.normalForce, wrench.torque, wrench.point);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, SoftSubsteps::Record>& heap) {
  archive(heap.time, heap.state, heap.step, heap.startEnergy, heap.hasSleepChanged, heap.atRest);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, UniformMotion>& motion) {
  archive(motion.position, motion.velocity, motion.acceleration);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, SphereFlights::Record>& flight) {
  archive(flight.motion, flight.since, flight.supports);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, HardSpheres::Record>& spheres) {
  archive(spheres.state, spheres.flights, spheres.origin, spheres.originRest, spheres.time);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, WorldRecord>& world) {
  archive(world.time, world.frame, world.islands, world.groups, world.spheres, world.softIslands, world.promiseEnds,
          world.isToldOf, world.corrections, world.evaluations);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, LastingContact>& contact) {
  archive(contact.id, contact.bodyA, contact.bodyB, contact.begin, contact.end);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, StepLoss::Energies>& energies) {
  archive(energies.largestKinetic, energies.first.sum, energies.first.frames, energies.second.sum,
          energies.second.frames);
}

template <class Archive>
void visit(Archive& archive, Visited<Archive, RunRecord>& run) {
  archive(run.world, run.contacts, run.energies, run.warnings, run.events, run.cpuSeconds);
}

void addResting(const PartRecord& part, const std::vector<int>& sceneBodies, std::vector<char>& isResting) {
  const std::vector<int>& islands = part.history.resting.islands;
  for (std::size_t body = 0; body < islands.size(); ++body)
    if (islands[body] >= 0) isResting[static_cast<std::size_t>(sceneBodies[body])] = 1;
}

std::string bytesOf(const RunRecord& record) {
  ByteWriter writer;
  writer(record);
  return textHash(writer.bytes()) + writer.bytes();
}

Checkpoint checkpointOf(const RunRecord& record, const std::string& bytes) {
  return {record.world.frame, record.events, record.contacts.count(), record.contacts.goingOn(), bytes};
}

RunRecord runRecordOf(std::string_view bytes) {
  const std::string content(bytes.substr(std::min(kHashDigits, bytes.size())));
  if (textHash(content) != bytes.substr(0, kHashDigits))
    throw Error(ErrorKind::output, "", "a record of a run is damaged");
  RunRecord record;
  ByteReader reader(content);
  reader(record);
  CRADLE_CHECK(reader.isAtEnd());
  return record;
}

}  // namespace cradle
