#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "simulate/events/contact_record.h"
#include "simulate/events/event_tolerances.h"
#include "simulate/island_state.h"
#include "simulate/rows_of_contacts.h"

namespace cradle {

/// An event of an active contact inside a step.
struct ContactChange {
  enum class Kind {
    release,  // its force would have to pull
    slip,     // friction gives way
    stick,    // sliding stops
    leave,    // loss of contact: the contact comes to the border of its face or edge, or off its corner, or a disc lies
              // down
    load,     // an idle contact would carry load
    redundant  // statically indeterminate with others: no forces within the friction cones keep them any more, or those
               // that the rows have would pull where it slides, so that friction would drive it
  };
  Kind kind = Kind::release;
  double fraction = 0;      // of the step, 0..1
  std::size_t contact = 0;  // index into Mechanism::contacts
  double latest = 1;        // of the step: where another change comes, or where it has not been searched any more
};

/// The search for changes of active contacts within steps. Each contact has an event function for each kind of change,
/// positive before it and zero at it: its normal force, the friction that is left, the velocity along its direction of
/// sliding, the distance from the border of its feature, and what presses its pair where that slides (E. Hairer, S. P.
/// Norsett, G. Wanner, "Solving Ordinary Differential Equations I", II.6). `records` are always those of the island's
/// Mechanism::contacts.
class ContactChanges {
 public:
  /// Keeps references to both. Of `island` it evaluates the equations.
  ContactChanges(IslandState& island, const EventTolerances& tolerances) : island_(island), tolerances_(tolerances) {}

  /// The contacts have changed: nothing is known of the next step's start.
  void forget() { knownTime_ = NAN; }

  /// Takes the forces that were evaluated last for those at the end of the island's step. To be called after steps of
  /// order 5, which end with them, before `first`.
  void noteEnd(const std::vector<ContactRecord>& records);

  /// The first change within the island's step, whose end derivative must be there.
  std::optional<ContactChange> first(const std::vector<ContactRecord>& records);

  /// The event function of a change at a fraction of the step, where it has come to `state`. Of redundant contacts that
  /// of their sliding alone tells.
  double margin(const ContactChange& change, const std::vector<ContactRecord>& records, double fraction,
                const VectorX& state);

  /// N: the normal force of a contact at the end of a step in which `first` found no change.
  double normalForceAtEnd(std::size_t contact, const std::vector<ContactRecord>& records) const {
    return before_[contact][0] * records[contact].force;
  }

 private:
  /// Of a contact, in the order of the kinds.
  /// Behind them, for contacts that are redundant, of which single forces tell nothing: what is left of the friction of
  /// its whole pair, if it sticks; and how far rows are from contradicting each other.
  using EventFunctions = std::array<double, 8>;

  Mechanism& mechanism() const { return island_.assembly.mechanism; }
  Vec3 slidingDirectionAt(std::size_t contact, double time, const VectorX& state) const;
  double distanceFromNearest(std::size_t contact, const ContactRecord& record, const VectorX& state) const;
  Vec3 tiltOf(const ContactConstraint& rim, const VectorX& state) const;
  double flatnessOf(const ContactConstraint& rim, const VectorX& state) const;
  double slidingNormalForce(std::size_t contact, const std::vector<ContactRecord>& records) const;
  std::optional<double> firstOverturning(std::size_t contact, double from, double to);
  double timeAt(double fraction) const { return island_.step.time + fraction * island_.step.timeStep; }
  void evaluate(const std::vector<ContactRecord>& records, double fraction, const VectorX& state,
                std::vector<EventFunctions>& values);
  void takeEvaluated(const std::vector<ContactRecord>& records, double time, const VectorX& state,
                     std::vector<EventFunctions>& values);
  bool slidesAsFace(std::size_t contact, const std::vector<ContactRecord>& records) const;
  double agreementOf(std::size_t contact) const;
  double idleLeft(std::size_t contact, const std::vector<ContactRecord>& records) const;
  double stickingLeft(std::size_t contact, const std::vector<ContactRecord>& records) const;
  std::optional<ContactChange> firstInDip(const std::vector<ContactRecord>& records, double earlier, double from,
                                          double to);
  ContactChange firstBefore(const std::vector<ContactRecord>& records, double from, ContactChange found);
  std::optional<ContactChange> firstBetween(const std::vector<ContactRecord>& records, double from, double to);
  std::optional<ContactChange> firstZero(const std::vector<ContactRecord>& records, double from, double to);
  struct GroupRows {
    std::vector<const ContactRecord*> records;
    std::vector<ContactRows> rows;
  };
  GroupRows rowsOfGroup(const std::vector<int>& contacts, std::vector<ContactRecord>& sliding, double time,
                        const VectorX& state) const;
  double infeasibility(const std::vector<ContactRecord>& records, double fraction);
  struct Trial {
    double fraction, infeasibility;
  };
  void narrow(const std::vector<ContactRecord>& records, Trial& last, Trial& first);
  std::optional<double> firstInfeasible(const std::vector<ContactRecord>& records, double from, double to);
  double locate(const ContactChange& change, const std::vector<ContactRecord>& records, double from, double marginFrom,
                double to, double marginTo);

  IslandState& island_;
  const EventTolerances& tolerances_;
  std::vector<BodyFrame> frames_;
  VectorX derivative_, sample_;
  std::vector<char> isInDoubt_;  // of each contact: its row's force, of minimum norm, does not prove that it lasts
  std::vector<EventFunctions> earlier_, before_, ahead_, after_, atEnd_;
  double knownTime_ = NAN;  // s: of the values in before_, if a step without changes has ended there
};

}  // namespace cradle
