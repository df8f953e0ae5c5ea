#pragma once

#include <algorithm>

namespace cradle {

/// Residuals (m/s) with which a search for a solution of the frictional contact problem is content. The residual of a
/// problem is that of the contact that is farthest from Coulomb's law (coulombResidual).
struct SearchTolerances {
  // Of the largest free velocity. 1e4 unit roundoffs, which Newton's method leaves of velocities if the condition
  // number is 1e4. A tenth or ten times as much changes no test.
  static constexpr double kConvergedRatio = 1e-12;
  // The same, where rounding is far larger. Interior points come no nearer, and where Newton's method does not
  // either, more trials only find rounding.
  static constexpr double kGoodRatio = 1e-9;
  // The same: a residual that is larger is not one of rounding, but of impulses that grow without bound. Impulses whose
  // rounding is as large are 3e8 times the velocities, in scaled units (kProductRounding).
  static constexpr double kMaxRoundingRatio = 1e-6;

  /// `fastest` (m/s): the largest free velocity of the problem. `asked` (m/s): the residual that is asked for; 0: as
  /// little as rounding allows.
  SearchTolerances(double fastest, double asked)
      : isRounding(asked == 0),
        interiorTrial(isRounding ? 4 : 1),
        solved(isRounding ? kConvergedRatio * fastest : asked),
        solvedHard(10 * solved),
        good(isRounding ? kGoodRatio * fastest : 0),
        maxRounding(kMaxRoundingRatio * fastest),
        interior(std::max(0.5 * solved, kGoodRatio * fastest)) {}

  bool isRounding;
  // Number of the trial that is one of interior points; the others are of ADMM. ADMM shares the loads of redundant
  // contacts about evenly, interior points do not: where forces are asked for to rounding, ADMM has four trials first.
  int interiorTrial;
  double solved;       // m/s: small enough
  double solvedHard;   // m/s: small enough after the interior point method, which such a problem has defeated
  double good;         // m/s: small enough to end the search after the interior point method
  double maxRounding;  // m/s: larger residuals are not taken for rounding
  double interior;     // m/s: where the interior point method ends; it comes no nearer than to kGoodRatio
};

/// Speeds (m/s) that an impact with friction takes for none, from the fastest velocity of its contacts.
struct FrictionalImpactTolerances {
  explicit FrictionalImpactTolerances(double fastest)
      : closed(10 * SearchTolerances::kConvergedRatio * fastest),
        sliding(SearchTolerances::kGoodRatio * fastest),
        solved(1e-7 * fastest),
        wedged(1e-4 * fastest) {}

  double closed;   // closing speeds that are left: ten times the residual of a problem that is solved to rounding
  double sliding;  // slower contacts stick: a problem that is solved well may leave as much to a contact that sticks
  double solved;   // residuals that are not reported: a thousandth of the coarsest accuracy that is not visual, 1e-4
  double wedged;   // a larger residual, as large as visual accuracies, is that of a problem without solution
};

}  // namespace cradle
