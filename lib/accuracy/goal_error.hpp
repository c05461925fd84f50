// How much of one figure (a force, the pressure at a place, a displacement) is the mesh: the error of the stresses
// weighed by how much the figure depends on them.
#pragma once

#include "form/solid.hpp"

#include <span>
#include <vector>

namespace amontons {

struct GoalError {
  double error = 0.0; // estimate of exact minus computed figure, with its sign, in the unit of the figure
  double bound = 0.0; // Σ over cells of |part|: what it would be if nothing cancelled; not below |error|
  /// |part| of each cell of this rank, block by block as in Mesh::blocks.
  std::vector<double> cells;
};

/// The dual weighted residual method with recovered stresses (R. Becker and R. Rannacher, Acta Numerica 10, 2001; with
/// patch recovery as in F. Cirak and E. Ramm, CMAME 156, 1998). A figure Q of the solution u has an influence field z:
/// the displacements under the load dQ/du in the linearised problem. With e and e_z the errors of the finite elements
/// in u and z, the error of Q is a(e, e_z) = ∫ Δσ(u) : Δε(z), where Δ is recovered minus computed. Of linear elastic
/// solids; where and whether surfaces touch is taken as found. Cells with a mean dilatation are no Galerkin method with
/// the displacements alone: with δ = div − mean div, their right-hand sides miss the work of the pressures on δ, and
/// the error has −∫ p*(u) δ(z) + p*(z) δ(u) besides, p* the recovered mean stress. `influences`: the displacement z of
/// each figure (num_local x dim). One error a figure. Collective.
std::vector<GoalError> estimate_goal_errors(SolidForm& solid, const Mesh& mesh, const State& state,
                                            std::span<const std::vector<double>> influences);

} // namespace amontons
