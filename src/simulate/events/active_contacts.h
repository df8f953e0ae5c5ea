#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "impact/frictional_contact.h"
#include "simulate/contact_response.h"
#include "simulate/island_state.h"

namespace cradle {

constexpr double kFlatRim = 1e-3;  // sine of a disc's tilt: flatter, its lowest point runs too fast around its rim

/// What happens to an active contact inside a step.
struct ContactChange {
  enum class Kind {
    release,  // its force would have to pull
    slip,     // friction gives way
    stick,    // sliding stops
    leave,    // loss of contact: the contact comes to the border of its face or edge, or off its corner, or a disc lies
              // down
    redundant  // statically indeterminate with others, which no forces hold any more
  };
  Kind kind = Kind::release;
  double fraction = 0;      // of the step, 0..1
  std::size_t contact = 0;  // index into Mechanism::contacts
};

/// Active contacts: those that forces press together, as rows of the equations of motion (Mechanism::contacts). Each
/// is classified as sticking or sliding, and stays so within a step; a change is an event. (F. Pfeiffer, C. Glocker,
/// "Multibody Dynamics with Unilateral Contacts", 1996)
class ActiveContacts {
 public:
  /// Keeps a reference to `island`. What comes within `reach` (m) touches.
  ActiveContacts(IslandState& island, double reach) : island_(island), reach_(reach) {}

  /// Releases all contacts, until `classify`. `change` is what happens to one of the contacts now, if anything does.
  void release(const std::optional<ContactChange>& change);

  /// Which of the touching contacts that do not leave each other last, and how, by the forces between them; those of
  /// bodies that all rest are left out. `constraints` must be factorised for the state. Records slip, stick, roll and
  /// release.
  void classify(const std::vector<Contact>& touching, ConstraintSolver& constraints);

  /// Releases contacts between bodies that have come to rest.
  void releaseResting();

  bool empty() const { return mechanism().contacts.empty(); }

  /// Features that active contacts hold together, for the pairs of now.
  const std::vector<ActiveFeature>& features();

  /// Takes the forces that were found last for those at the end of the island's step. To be called after steps of order
  /// 5, which end with them, before firstChange.
  void noteEnd();

  /// The first change of an active contact within the island's step, whose end derivative must be there.
  std::optional<ContactChange> firstChange();

  /// Zero where the change happens, positive before. Not for redundant ones.
  double margin(const ContactChange& change, const VectorX& state);

  /// Directions of sliding follow the motion from step to step. Notes as a reason to fall back to time stepping that
  /// friction goes on turning them faster than steps follow at a bearable cost: a body that creeps under a load.
  void followSliding();

  /// Why rows do not serve, if they don't: they are for few contacts, and only those between spheres, corners and
  /// faces.
  std::string_view fallbackReason() const { return fallbackReason_; }

  /// Notes as a reason to fall back to time stepping that friction jams where contacts slide now. False if none does.
  bool noteJam();

  /// Notes as a reason to fall back to time stepping that joints leave one of these contacts a lever of less than
  /// `lever`, in sizes of its bodies. `constraints` are factorised for the state.
  void noteShortMomentArms(const std::vector<Contact>& touching, ConstraintSolver& constraints, double lever);

  /// The bodies of the scene whose contacts the fault is about, and those of all that last.
  const std::vector<int>& fallbackBodies() const { return fallbackBodies_; }
  std::vector<int> sceneBodies() const;

 private:
  /// A contact that touches, on its way to a decision; and what is known of one that lasts, beside its constraint.
  struct ContactRecord {
    Contact contact;  // where and when it was decided
    ColliderPair pair;
    bool slides = false;
    Vec3 direction = Vec3::Zero();  // unit, world, of A's sliding, if it slides
    bool isLoaded = false, sticks = false;
    bool opens = false;        // carries nothing, and the accelerations open it
    bool isRedundant = false;  // its forces are not unique
    double mass = 1;           // kg, against being pushed apart there
    double force = 1;          // N, that margins are measured by
  };
  /// A contact that lasted until now.
  struct PreviousContact {
    ContactRecord record;
    ContactConstraint constraint;
    bool isSlipping = false;       // friction gives way now ...
    Vec3 slipping = Vec3::Zero();  // ... and A will slide there; unit, world
  };
  using ContactGroup = std::vector<std::size_t>;  // records whose forces depend on each other

  Mechanism& mechanism() const { return island_.assembly.mechanism; }
  std::vector<ContactRecord> recordsOf(const std::vector<Contact>& touching) const;
  std::vector<ContactGroup> groupsOf(const std::vector<ContactRecord>& records) const;
  void classify(const ContactGroup& group, std::vector<ContactRecord>& records, ConstraintSolver& constraints);
  void noteUnsolved(const std::vector<const ContactRecord*>& records, double residual) const;
  void noteTipping(const std::vector<ContactRecord>& records);
  bool isOfRim(const Contact& contact) const;
  double tippingSpeed(const Contact& contact) const;
  double stillSpeed(const Contact& contact) const;
  bool slidesTooSlowly(const ContactRecord& record, double acceleration, double gravity) const;
  void countRows(const ContactGroup& group, const MatrixX& delassus, std::vector<ContactRecord>& records);
  void noteFallback(std::string_view reason, const std::vector<const Contact*>& contacts);
  std::vector<int> sceneBodiesOf(const std::vector<const Contact*>& contacts) const;
  static VectorX pressingOf(const std::vector<const ContactRecord*>& records, const VectorX& impulses);
  static VectorX frictionOf(const std::vector<const ContactRecord*>& records, const std::vector<ContactRows>& rows,
                            const VectorX& pressing);
  bool nothingCloses(const std::vector<ContactRows>& rows) const;
  ContactSolution solve(const std::vector<const ContactRecord*>& records, const std::vector<ContactRows>& rows,
                        const ContactResponse& response) const;
  void add(const ContactRecord& record);
  void recordChanges();
  const PreviousContact* previousOf(const ContactRecord& record) const;
  bool reverses(const PreviousContact& previous, const ContactRecord& now) const;
  bool isAwake(const Contact& contact) const;

  /// Of a contact's changes, in the order of their kinds.
  using EventFunctions = std::array<double, 4>;

  Vec3 givenDirection(std::size_t contact, const VectorX& state) const;
  double distanceFromNearest(std::size_t contact, const VectorX& state) const;
  static double insideBorder(const Contact& contact, const SphereOverMesh& sphere);
  std::optional<ContactChange> firstLeaving() const;
  void noteMeshes(const std::vector<ContactRecord>& records);
  double flatnessOf(const ContactConstraint& rim, const VectorX& state) const;
  void findEventFunctions(const VectorX& state, std::vector<EventFunctions>& eventFunctions);
  void takeEventFunctions(const VectorX& state, std::vector<EventFunctions>& eventFunctions);
  bool areForcesFeasible(const VectorX& state);
  std::optional<double> firstInfeasible(double from, double to);
  double locate(const ContactChange& change, double from, double marginFrom, double to, double marginTo);

  IslandState& island_;
  double reach_;                        // m
  std::vector<ContactRecord> records_;  // of Mechanism::contacts
  std::vector<PreviousContact> previous_;
  std::vector<ActiveFeature> features_;
  std::vector<BodyFrame> frames_;
  std::string_view fallbackReason_;
  std::vector<int> fallbackBodies_;
  bool isReleasing_ = false;
  int turningSteps_ = 0;  // in a row, in which friction turned some sliding
  VectorX derivative_, sample_;
  std::vector<EventFunctions> before_, ahead_, after_, atEnd_;
  double knownTime_ = NAN;  // s: of the margins in before_, if a step that changed nothing has ended there
};

}  // namespace cradle
