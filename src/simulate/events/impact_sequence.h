#pragma once

#include <optional>
#include <vector>

#include "collision/separation.h"

namespace cradle {

/// Limits of a sequence of impacts at frozen places.
struct SequenceLimits {
  std::vector<double> gapErrors;   // m, of each contact: a gap below it is none
  std::vector<double> gapOffsets;  // m, of each contact: by so much is its separation more than its gap; empty: 0
  double gapRounding = 0;          // m: rounding may hide gaps about as small from the events that follow
  double shortestTime = 0;         // s: an instant so little later is the same
  double leastRounding = 0;        // m: the same, where a gap is known better than this and its separation tells it
  double touchTolerance = 0;       // m: bound on the gap that the pair of an event seems to have
  double reach = 0;                // m: contacts farther apart are not known, so bodies move by half of it at most
  double duration = 0;             // s: in a longer time forces count
  double acceleration = 0;         // m/s^2: by which gaps may close beside their speeds
  double stillSpeed = 0;           // m/s: closing more slowly is rounding
  double openingSpeed = 0;         // m/s: a contact without a gap that opens more slowly stays without
};

/// Impacts that follow each other faster than bodies move: contacts close in the order of s / -s', s their gaps, while
/// positions, and with them normals and the Delassus operator, stay as they are. Gaps are variables of their own: a gap
/// that an impact has closed is zero, and grows from there by speed x time, with a relative error of rounding however
/// small it is, unless the contact opens so slowly that it counts as closed after the sequence too. Contacts whose gaps
/// close at one instant, and those without a gap that do not open, are one impact.
///
/// Impacts may be infinitely many in a finite time (inelastic collapse: a light sphere between the floor and a heavy
/// one, with a small restitution). Neither gaps nor speeds tell that, but the history does: the intervals shrink
/// geometrically. Then one impact without rebound ends the sequence.
class ImpactSequence {
 public:
  /// `closingPair`: the pair that an event has brought together, whose nearest contact has no gap. `radii` (m): of all
  /// moving bodies.
  ImpactSequence(std::vector<Contact> contacts, const std::optional<std::size_t>& closingPair,
                 const std::vector<double>& radii, const SequenceLimits& limits, const VectorX& state);

  const std::vector<Contact>& contacts() const { return contacts_; }

  /// Of a contact, m: its gap now, and the error of that.
  double gap(std::size_t contact) const { return gaps_[contact]; }
  double gapError(std::size_t contact) const { return gapErrors_[contact]; }

  /// Whether the gap of a contact, measured anew, might be none.
  bool isWithinRounding(std::size_t contact) const;

  /// Whether its first impact takes no time: else ropes at their length pull before it.
  bool beginsNow() const { return timeToNextImpact() == 0; }

  /// Goes on to the next impact; false if there is none within the limits. `state` has the velocities of now.
  bool next(const VectorX& state);

  /// The contacts of that impact, indices of contacts(): some close, the others touch.
  const std::vector<std::size_t>& members() const { return members_; }

  /// Whether that impact ends a collapse: nothing rebounds.
  bool isCollapse() const { return isCollapse_; }

  /// Takes the velocities after that impact.
  void finishImpact(const VectorX& state);

  /// Moves all bodies to where they are when the sequence ends, those that it has not struck too: their next impact may
  /// be as close in time. False if the sequence took no time.
  bool moveBodies(VectorX& state) const;

 private:
  void closeGapOf(std::size_t pair);
  void closeGap(std::size_t contact);
  void findSpeeds(const VectorX& state);
  bool closes(std::size_t contact) const;
  bool hasCollapsed() const;
  bool closeWithinRounding();
  double timeToNextImpact() const;
  bool closesLater(std::size_t contact) const;
  bool mayAdvance(const VectorX& state, double time) const;
  void advance(const VectorX& state, double time);
  void findMembers();

  std::vector<Contact> contacts_;
  const std::vector<double>& radii_;
  SequenceLimits limits_;
  std::vector<double> gaps_, gapErrors_;     // m
  std::vector<double> offsets_;              // m: separations, as they would be measured now, minus gaps
  std::vector<double> speeds_;               // m/s, of opening
  std::vector<double> leftSpeeds_;           // m/s, <= 0: of closing that its last impact could not end
  std::vector<std::size_t> lastImpacts_;     // of each contact: number of its last impact, from 1; 0: none
  std::vector<double> times_;                // s: of the impacts, from the sequence's start
  std::size_t collapses_ = 0;                // number of the impact that ended the last collapse
  double elapsed_ = 0, fastestClosing_ = 0;  // s, m/s
  std::vector<std::size_t> members_;
  bool isCollapse_ = false;
  VectorX displacements_;  // m and rad: six of each body
};

}  // namespace cradle
