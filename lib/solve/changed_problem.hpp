// A Problem written in other unknowns û, u = T û: residual Tᵀ r(T û) and tangent Tᵀ K T, with prescribed displacements
// left where they are. What the solvers for contact on transformed unknowns share.
#pragma once

#include "form/problem.hpp"
#include "solve/free_motions.hpp"

#include <vector>

namespace amontons {

class ChangedProblem {
 public:
  explicit ChangedProblem(Problem& problem);

  /// Takes another T and its inverse, with a prescribed displacement the same unknown in u and û. They must outlive
  /// the next call. Collective.
  void take_transform(Mat transform, Mat inverse);
  bool has_transform() const { return transform_ != nullptr; }

  /// Assembles Tᵀ K T at u = `unknowns`, or at û, only if it would differ from the last one; returns whether it did.
  /// Collective.
  bool tangent_at(Vec unknowns);
  bool tangent(Vec changed);
  /// Tᵀ K T as of the last call: another matrix after take_transform, and where `tangent` says so perhaps.
  Mat matrix() const { return changed_tangent_; }

  /// Tᵀ r(T û); false where the problem has no residual. Collective.
  bool residual(Vec changed, Vec result);
  /// û = T⁻¹ u. Collective.
  void to_changed(Vec unknowns, Vec changed) const;
  /// u = T û of the last residual or tangent.
  Vec unknowns() const { return unknowns_; }

  /// Rigid motions of bodies that neither the last tangent nor the unknowns û that are held (one in `held`, else zero)
  /// resist. Collective.
  std::vector<FreeMotion> free_motions(Vec held) const;

  /// û of the rigid motions, orthonormal: the near-null space of Tᵀ K T. Collective.
  NullSpaceHandle modes() const;

 private:
  Problem& problem_;
  Mat transform_ = nullptr, inverse_ = nullptr; // not owned
  MatHandle tangent_;                           // K
  MatHandle variation_;                         // T without the columns of prescribed displacements: they do not vary
  MatHandle changed_tangent_;                   // Tᵀ K T
  VecHandle unknowns_, residual_;
};

} // namespace amontons
