#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "simulate/events/contact_changes.h"
#include "simulate/events/contact_record.h"
#include "simulate/events/event_tolerances.h"
#include "simulate/events/previous_contacts.h"
#include "simulate/island_state.h"

namespace cradle {

/// The bodies of an active contact.
struct BodiesInContact {
  int bodyA = 0, bodyB = 0;  // of the scene
  bool isMirrored = false;   // A of the constraint is B
};

/// Active contacts: those that forces press together, as rows of the equations of motion (Mechanism::contacts). Each
/// is classified as sticking or sliding (contact_classification.h), and stays so within a step; a change is an event
/// (contact_changes.h).
class ActiveContacts {
 public:
  /// Keeps references to both.
  ActiveContacts(IslandState& island, const EventTolerances& tolerances)
      : island_(island), tolerances_(tolerances), changes_(island, tolerances) {}

  /// Releases all contacts, until `classify`. `change` is the event of one of the contacts, if it is one of theirs.
  void release(const std::optional<ContactChange>& change);

  /// Makes those of the touching contacts active that carry load; those of bodies that all rest are left out.
  /// `constraints` must be factorised for the state. Records slip, stick, roll and release.
  void classify(const std::vector<Contact>& touching, ConstraintSolver& constraints);

  /// Releases contacts between bodies that have come to rest.
  void releaseResting();

  bool empty() const { return mechanism().contacts.empty(); }

  /// The bodies of Mechanism::contacts.
  const std::vector<BodiesInContact>& bodies() const { return bodies_; }

  /// The features that touch at active contacts, for the near pairs of now.
  const std::vector<ActiveFeature>& features();

  /// Takes the forces that were found last for those at the end of the island's step. To be called after steps of order
  /// 5, which end with them, before firstChange.
  void noteEnd() { changes_.noteEnd(records_); }

  /// The first change of an active contact within the island's step, whose end derivative must be there.
  std::optional<ContactChange> firstChange() { return changes_.first(records_); }

  /// Zero where the change happens, positive before. Not for redundant ones.
  double margin(const ContactChange& change, const VectorX& state) {
    return changes_.margin(change, records_, 1, state);
  }

  /// Gives contacts that stop sliding at a fraction of the island's step the direction in which they stop, for a step
  /// that ends there: the velocity itself tells no direction where it is as small as its error. False if none does so
  /// straight enough.
  bool aimAtStop(double fraction);

  /// Directions of sliding follow the motion from step to step. Notes as a reason to fall back to time stepping that
  /// friction goes on turning them faster than steps follow at a bearable cost: a body that creeps under a load. If
  /// contacts that kept their directions are free now, friction has changed: returns the time (s) in which it turns
  /// them.
  std::optional<double> followSliding();

  /// s: when the next contact that keeps its direction of sliding is free; infinite if there is none.
  double nextFreeDirection() const;

  /// Why rows do not serve, if they don't: they are for few contacts, and only those between spheres, corners and
  /// faces.
  std::string_view fallbackReason() const { return fallback_.reason; }

  /// Notes as a reason to fall back to time stepping that a cylinder tips over its rim at the contact.
  void noteTipping(const Contact& contact);

  /// Notes as a reason to fall back to time stepping that friction jams where contacts slide now. False if none does.
  bool noteJam();

  /// Notes as a reason to fall back to time stepping that joints leave one of these contacts a moment arm of less than
  /// `momentArm`, in sizes of its bodies. `constraints` are factorised for the state.
  void noteShortMomentArms(const std::vector<Contact>& touching, ConstraintSolver& constraints, double momentArm);

  /// The scene bodies that the reason is about, and those of all active contacts.
  const std::vector<int>& fallbackBodies() const { return fallback_.bodies; }
  std::vector<int> sceneBodies() const;

 private:
  Mechanism& mechanism() const { return island_.assembly.mechanism; }
  void add(const ContactRecord& record, const std::vector<BodyFrame>& frames);
  void addIdle(const ContactRecord& idle);
  std::vector<Vec3> slidingVelocitiesAt(double fraction);

  IslandState& island_;
  const EventTolerances& tolerances_;
  std::vector<ContactRecord> records_;   // of Mechanism::contacts
  std::vector<BodiesInContact> bodies_;  // the same
  std::vector<PreviousContact> previous_;
  ContactChanges changes_;
  std::vector<ActiveFeature> features_;
  std::vector<BodyFrame> frames_;  // of the island's state, or of a sample
  VectorX sample_;
  ContactFallback fallback_;
  bool isReleasing_ = false;
  int turningSteps_ = 0;  // in a row, in which friction turned the direction of some sliding
  double maxTurningSteps_ = 0;
};

}  // namespace cradle
