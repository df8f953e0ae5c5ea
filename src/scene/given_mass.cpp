#include "scene/given_mass.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>

namespace cradle {
namespace {

// Relative to the largest entry: what writing tensors with six digits may do, and what computing eigenvalues may.
constexpr double kWrittenRounding = 1e-5;
constexpr double kComputedRounding = 1e-12;

std::optional<Mat3> readMatrix(const Field& field, FaultList& faults) {
  const std::vector<Field> rows = readItems(field, 3, faults);
  if (rows.empty()) return std::nullopt;
  Mat3 matrix;
  bool isSound = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = readVector(rows[i], kMomentEntries, "kg m^2", faults);
    isSound = isSound && row.has_value();
    matrix.row(static_cast<Eigen::Index>(i)) = row.value_or(Vec3::Zero());
  }
  return isSound ? std::optional(matrix) : std::nullopt;
}

// A body's principal moments are integrals of y^2 + z^2, z^2 + x^2, x^2 + y^2: positive, none above the sum of the
// others. Empty if `inertia` is one.
std::string inertiaFault(const Mat3& inertia) {
  const double largest = inertia.cwiseAbs().maxCoeff();
  if (largest == 0) return "the inertia tensor is zero; it must be positive definite";
  const Mat3 scaled = inertia / largest;
  if ((scaled - scaled.transpose()).cwiseAbs().maxCoeff() > kWrittenRounding) {
    return "the inertia tensor is not symmetric; entries (i, j) and (j, i) must be equal";
  }
  const Vec3 moments = Eigen::SelfAdjointEigenSolver<Mat3>(scaled, Eigen::EigenvaluesOnly).eigenvalues();
  const std::string principal =
      fmt::format("{:.6g}, {:.6g}, {:.6g} kg m^2", moments[0] * largest, moments[1] * largest, moments[2] * largest);
  if (moments[0] <= kComputedRounding) {
    return "the principal moments of inertia are " + principal + "; all must be > 0";
  }
  if (!kMoments.holds(moments[0] * largest)) {
    return fmt::format("the principal moments of inertia are {}; all must be in {:g}..{:g}", principal, kMoments.least,
                       kMoments.most);
  }
  if (moments[0] + moments[1] < moments[2] * (1 - kWrittenRounding)) {
    return "the principal moments of inertia are " + principal +
           "; the largest must not exceed the sum of the others (no body has such moments)";
  }
  return "";
}

bool isUsable(const MassProperties& properties) {
  const Vec3 diagonal = properties.inertiaTensor.diagonal();
  return kMasses.holds(properties.mass) && properties.centerOfMass.allFinite() &&
         properties.inertiaTensor.allFinite() && kMoments.holds(diagonal.minCoeff()) &&
         kMoments.holds(diagonal.maxCoeff());
}

void parseMassFrom(ObjectReader& reader, BodyDraft& draft) {
  FaultList& faults = reader.faults();
  draft.massFromField = reader.find("massFrom");
  draft.massFrom = reader.choice<MassFrom>(
      "massFrom", {{"solid", MassFrom::solid}, {"hull", MassFrom::hull}, {"shell", MassFrom::shell}}, draft.massFrom);
  const auto thickness = reader.find("thickness");
  draft.thickness = reader.number("thickness", kLengths, "m", draft.thickness);
  const bool isShell = draft.massFrom == MassFrom::shell;
  if (thickness && !isShell)
    addFault(faults, *thickness, "thickness goes with \"massFrom\": \"shell\" only; remove it");
  if (isShell && !thickness && !reader.find("mass"))
    addFault(faults, *draft.massFromField,
             "a shell weighs density x area x thickness; give \"thickness\" (m), or \"mass\" (kg)");
}

}  // namespace

void parseGivenMass(ObjectReader& reader, BodyDraft& draft) {
  FaultList& faults = reader.faults();
  parseMassFrom(reader, draft);
  const auto mass = reader.find("mass");
  draft.mass = reader.optionalNumber("mass", kMasses, "kg");
  const auto centerOfMass = reader.find("centerOfMass"), inertiaTensor = reader.find("inertiaTensor");
  if (centerOfMass) draft.centerOfMass = readVector(*centerOfMass, kCoordinates, "m", faults);
  if (inertiaTensor) {
    draft.inertiaTensor = readMatrix(*inertiaTensor, faults);
    const std::string fault = draft.inertiaTensor ? inertiaFault(*draft.inertiaTensor) : "";
    if (!fault.empty()) addFault(faults, *inertiaTensor, fault);
  }
  if (mass) return;
  for (const auto& override : {centerOfMass, inertiaTensor}) {
    if (override) addFault(faults, *override, "it is given without mass; give \"mass\" too");
  }
}

MassProperties completeMass(const BodyDraft& draft, const std::optional<MassProperties>& ofShape, double density,
                            FaultList& faults) {
  MassProperties result;
  if (ofShape) {
    const double factor = draft.mass ? *draft.mass / ofShape->mass : density;
    result = {ofShape->mass * factor, ofShape->centerOfMass, ofShape->inertiaTensor * factor};
  }
  if (draft.mass) result.mass = *draft.mass;
  if (draft.centerOfMass) result.centerOfMass = *draft.centerOfMass;
  if (draft.inertiaTensor) {
    result.inertiaTensor = 0.5 * *draft.inertiaTensor + 0.5 * draft.inertiaTensor->transpose();
  }
  if (!isUsable(result)) {
    const Vec3 diagonal = result.inertiaTensor.diagonal();
    addFault(faults, draft.field,
             fmt::format("the mass comes out as {} kg and the moments of inertia as {}, {}, {} kg m^2; allowed "
                         "are {:g}..{:g} kg and {:g}..{:g} kg m^2; check size, scale, density and mass",
                         result.mass, diagonal.x(), diagonal.y(), diagonal.z(), kMasses.least, kMasses.most,
                         kMoments.least, kMoments.most));
  }
  return result;
}

}  // namespace cradle
