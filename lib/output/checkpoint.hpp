// checkpoint.h5: everything a run needs to go on, on any number of ranks. Nodal values are found again by Mesh::keys,
// which do not depend on the partition, values on facets and cells by the keys of their corners.
#pragma once

#include "mesh/mesh.hpp"

#include <map>
#include <string>
#include <vector>

namespace amontons {

/// Values at the nodes of a mesh.
struct NodalArray {
  int components = 1;
  std::vector<double> values; // num_local() x components; ghosts included
};

/// Rows of numbers on the facets of a surface, as many on each as it likes (one a quadrature point, say). The order of
/// a facet's nodes may be another after a restart, and with it that of its points: a row must say by itself what it
/// belongs to.
struct FacetArray {
  std::string surface; // name in Mesh::surfaces
  int components = 1;
  std::vector<std::int32_t> rows; // per facet of this rank
  std::vector<double> values;     // facet by facet: sum of rows x components
};

/// The same on the cells of a body.
struct CellArray {
  std::string body; // one of Mesh::bodies
  int components = 1;
  std::vector<std::int32_t> rows; // per cell of the body on this rank, block by block
  std::vector<double> values;     // cell by cell: sum of rows x components
};

struct Checkpoint {
  double time = 0.0;
  int step = 0;                // index of the deck's step that the accepted state belongs to
  int increment = 0;           // number of accepted increments since the start of the run
  double next_increment = 0.0; // time span that the next increment should try
  /// Numbers known to all ranks alike.
  std::map<std::string, std::vector<double>> global;
  std::map<std::string, NodalArray> nodal;
  std::map<std::string, FacetArray> facets;
  std::map<std::string, CellArray> cells;
};

/// Writes the checkpoint of a run on `mesh` to `path`, beside an older one until it is complete, then in its place: an
/// interrupted write destroys nothing. `identity` is a text of all that must be equal for a restart to make sense
/// besides the mesh (materials, contact pairs ...). Throws UserError when the file cannot be written. Collective.
void write_checkpoint(const Mesh& mesh, const std::string& path, const std::string& identity,
                      const Checkpoint& checkpoint);

/// Reads it back for `mesh`, however it is distributed now. Throws UserError when the file is missing or damaged, or
/// was written on another mesh or for another `identity`. Collective.
Checkpoint read_checkpoint(const Mesh& mesh, const std::string& path, const std::string& identity);

} // namespace amontons
