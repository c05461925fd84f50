// From errors of cells to the sizes that cells of the next mesh should have. The rule is a pure function; only
// `simplex_errors` knows a distributed mesh.
#pragma once

#include "accuracy/discretization_error.hpp"
#include "mesh/mesh.hpp"
#include "mesh/size_field.hpp"

#include <span>
#include <vector>

namespace amontons {

/// A triangle or tetrahedron with its error.
struct CellError {
  std::array<double, 3> place{}; // middle of its corners
  double edge = 0.0;             // of the equilateral cell of the same area or volume, length
  double square = 0.0;           // of the error, estimated; a work
  double rate = 1.0;             // q: the error of the cell is of order h^q
};

/// The cells of all ranks on rank 0 (empty elsewhere). `squares`: one a cell of this rank, in the order of
/// DiscretizationError::cells; `near_edge` likewise. The rate is the elements' order; near the edge of contact at most
/// 3/2, for there displacements go with r^(3/2). Precondition: all cells are triangles or tetrahedra. Collective.
std::vector<CellError> simplex_errors(const Mesh& mesh, std::span<const double> squares,
                                      std::span<const std::uint8_t> near_edge);

struct SizeRule {
  int dim = 2;
  double target = 0.0;     // error wanted in all, the root of a work
  double most_cells = 0.0; // the mesh gets no more than about so many cells
  double finest = 0.25;    // least and greatest size of a new cell over that of the old one: the error's law of powers
  double coarsest = 2.0;   // holds in some range only, and the estimate is poor on a mesh that is far too coarse
};

/// Wanted sizes, and what the rule expects of the new mesh.
struct WantedSizes {
  std::vector<SizeSample> samples;
  double error = 0.0; // root of a work
  double cells = 0.0;
};

/// The mesh with the fewest cells that has the error `target`. A cell of size h and error η, divided into cells of size
/// r h, makes r^-d of them with the error η r^q. The least of Σ r^-d under Σ η² r^2q = target² is where each new cell
/// has the same q-fold error: r = (c / (q η²))^(1 / (2 q + d)), with c from the constraint (P. Coorevits, P. Ladeveze,
/// J.-P. Pelle, Comput. Methods Appl. Mech. Engrg. 121 (1995) 91-120, section 3). Ratios are limited, and c is found
/// with the limits in force. Where `most_cells` is too few for the target, c is the one that has so many. Empty for no
/// cells.
WantedSizes wanted_sizes(std::span<const CellError> cells, const SizeRule& rule);

} // namespace amontons
