#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "impact/cone_problem.h"
#include "simulate/contact_response.h"
#include "simulate/moving_island.h"

namespace cradle {

constexpr double kFlatRim = 1e-3;  // sine of a disc's tilt: flatter, its lowest point runs too fast around its rim

/// What happens to a lasting contact inside a step.
struct ContactChange {
  enum class Kind {
    release,   // its force would have to pull
    slip,      // friction gives way
    stick,     // sliding stops
    leave,     // the contact comes to the border of its face or edge, or off its corner, or a disc lies down
    redundant  // no forces hold it together with others any more
  };
  Kind kind = Kind::release;
  double fraction = 0;      // of the step, 0..1
  std::size_t contact = 0;  // index into Mechanism::contacts
};

/// Contacts that last: those that forces press together, as rows of the equations of motion (Mechanism::contacts). They
/// stay as they are within a step. What changes them is an event.
class LastingContacts {
 public:
  /// Keeps a reference to `island`. What comes within `reach` (m) touches.
  LastingContacts(MovingIsland& island, double reach) : island_(island), reach_(reach) {}

  /// Lets go of everything, until `decide`. `change` is what happens to one of the contacts now, if anything does.
  void letGo(const std::optional<ContactChange>& change);

  /// Which of the touching contacts that do not leave each other last, and how, by the forces between them; those of
  /// bodies that all rest are left out. `ties` must be factorised for the state. Records slip, stick, roll and release.
  void decide(const std::vector<Contact>& touching, ConstraintSolver& ties);

  /// Lets go of contacts between bodies that have come to rest.
  void letGoResting();

  bool empty() const { return mechanism().contacts.empty(); }

  /// Features that lasting contacts hold together, for the pairs of now.
  const std::vector<HeldFeature>& held();

  /// Takes the forces that were found last for those at the end of the island's step. To be called after steps of order
  /// 5, which end with them, before firstChange.
  void noteEnd();

  /// The first change of a lasting contact within the island's step, whose end rate must be there.
  std::optional<ContactChange> firstChange();

  /// Zero where the change happens, positive before. Not for redundant ones.
  double margin(const ContactChange& change, const VectorX& state);

  /// Directions of sliding follow the motion from step to step. Notes as a fault that friction goes on turning them
  /// faster than steps follow at a bearable cost: a body that creeps under a load.
  void followSliding();

  /// Why rows do not serve, if they don't: they are for few contacts, and only those between balls, corners and faces.
  std::string_view fault() const { return fault_; }

  /// Notes as a fault that friction jams where contacts slide now. False if none does.
  bool noteJam();

  /// Notes as a fault that joints leave one of these contacts a lever of less than `lever`, in sizes of its bodies.
  /// `ties` are factorised for the state.
  void noteShortLevers(const std::vector<Contact>& touching, ConstraintSolver& ties, double lever);

  /// The bodies of the scene whose contacts the fault is about, and those of all that last.
  const std::vector<int>& faultBodies() const { return faultBodies_; }
  std::vector<int> sceneBodies() const;

 private:
  /// A contact that touches, on its way to a decision; and what is known of one that lasts, beside its constraint.
  struct Entry {
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
  struct Former {
    Entry entry;
    ContactConstraint constraint;
    bool isSlipping = false;       // friction gives way now ...
    Vec3 slipping = Vec3::Zero();  // ... and A will slide there; unit, world
  };
  using Together = std::vector<std::size_t>;  // entries whose forces depend on each other

  Mechanism& mechanism() const { return island_.assembly.mechanism; }
  std::vector<Entry> entriesOf(const std::vector<Contact>& touching) const;
  std::vector<Together> groupsOf(const std::vector<Entry>& entries) const;
  void decide(const Together& group, std::vector<Entry>& entries, ConstraintSolver& ties);
  void noteUnsolved(const std::vector<const Entry*>& entries, double residual) const;
  void noteTipping(const std::vector<Entry>& entries);
  bool isOfRim(const Contact& contact) const;
  double tippingSpeed(const Contact& contact) const;
  double stillSpeed(const Contact& contact) const;
  bool slidesTooSlowly(const Entry& entry, double acceleration, double gravity) const;
  void countRows(const Together& group, const MatrixX& held, std::vector<Entry>& entries);
  void noteFault(std::string_view fault, const std::vector<const Contact*>& contacts);
  std::vector<int> sceneBodiesOf(const std::vector<const Contact*>& contacts) const;
  static VectorX pressingOf(const std::vector<const Entry*>& entries, const VectorX& impulses);
  static VectorX frictionOf(const std::vector<const Entry*>& entries, const std::vector<ContactRows>& rows,
                            const VectorX& pressing);
  bool nothingCloses(const std::vector<ContactRows>& rows) const;
  ConeSolution solve(const std::vector<const Entry*>& entries, const std::vector<ContactRows>& rows,
                     const ContactResponse& response) const;
  void add(const Entry& entry);
  void recordChanges();
  const Former* formerOf(const Entry& entry) const;
  bool turnsBack(const Former& former, const Entry& now) const;
  bool isAwake(const Contact& contact) const;

  /// Of a contact's changes, in the order of their kinds.
  using Margins = std::array<double, 4>;

  Vec3 givenDirection(std::size_t contact, const VectorX& state) const;
  double distanceFromNearest(std::size_t contact, const VectorX& state) const;
  static double insideBorder(const Contact& contact, const BallOverMesh& ball);
  std::optional<ContactChange> firstLeaving() const;
  void noteMeshes(const std::vector<Entry>& entries);
  double flatnessOf(const ContactConstraint& rim, const VectorX& state) const;
  void findMargins(const VectorX& state, std::vector<Margins>& margins);
  void takeMargins(const VectorX& state, std::vector<Margins>& margins);
  bool isHeldTogether(const VectorX& state);
  std::optional<double> firstFailure(double from, double to);
  double locate(const ContactChange& change, double from, double marginFrom, double to, double marginTo);

  MovingIsland& island_;
  double reach_;                // m
  std::vector<Entry> entries_;  // of Mechanism::contacts
  std::vector<Former> former_;
  std::vector<HeldFeature> held_;
  std::vector<BodyFrame> frames_;
  std::string_view fault_;
  std::vector<int> faultBodies_;
  bool isReleasing_ = false;
  int turningSteps_ = 0;  // in a row, in which friction turned some sliding
  VectorX rate_, sample_;
  std::vector<Margins> before_, ahead_, after_, atEnd_;
  double knownTime_ = NAN;  // s: of the margins in before_, if a step that changed nothing has ended there
};

}  // namespace cradle
