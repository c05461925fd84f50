// From a .geo or .msh file to a distributed Mesh, in two stages: everything serial (gmsh, checks) on rank 0, then
// DMPlex.
#pragma once

#include "mesh/mesh.hpp"
#include "mesh/size_field.hpp"

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace amontons {

/// A .geo meshed anew: triangles or tetrahedra everywhere, whatever transfinite, extruded or recombined parts the
/// script asks for, so that cells can have any size.
struct FreeMeshing {
  std::shared_ptr<const SizeField>
      sizes; // absent: those of the script's background field, else of the mesh that it makes
};

struct MeshSource {
  std::string file;                         // .geo (meshed by gmsh) or .msh (2.2 and 4.1, text or binary)
  std::map<std::string, double> parameters; // values for the .geo's DefineConstant names
  std::optional<int> order;                 // 1 or 2; absent: 1 for .geo, the file's own for .msh
  std::optional<FreeMeshing> free = {};     // absent: as the script says
};

/// A physical group of the file.
struct PhysicalGroup {
  std::string name;
  int dim;
  std::int64_t num_elements;
};

/// The whole mesh of a file, before distribution. Node order within elements is gmsh's.
struct RawMesh {
  int dim = 0;
  int order = 1;
  std::vector<double> coordinates; // num_nodes x 3
  std::vector<ElementType> cell_types;
  std::vector<std::int64_t> cell_offsets = {0};
  std::vector<std::int64_t> cell_nodes;  // indices into coordinates
  std::vector<std::int32_t> cell_bodies; // index into groups
  std::vector<PhysicalGroup> groups;
  /// Elements of lower dimension in physical groups: corner nodes of each (gmsh order), and the group. One for each
  /// group that it is in.
  struct Sub {
    std::vector<std::int64_t> nodes;
    ElementType type;   // of order 1; meaningless for points (dim 0): nodes.size() == 1
    std::int32_t group; // index into groups
  };
  std::vector<Sub> subs;

  std::int64_t num_cells() const { return static_cast<std::int64_t>(cell_types.size()); }
  /// Names of the groups with this dimension; all groups for dim < 0.
  std::vector<std::string> group_names(int dim) const;
};

/// Reads or generates the mesh through the gmsh API. Serial: call on rank 0. Throws UserError with every fault that it
/// finds (missing or broken file, unknown parameter, cells without a physical group, inverted or degenerate cells,
/// cells of mixed dimension, unsupported element, empty surface group, cells in two bodies, ...).
RawMesh read_mesh(const MeshSource& source);

/// Throws UserError for each of the named groups that is not a set of boundary facets: a facet inside a body (shared by
/// two cells) or not a facet of any cell. Contact surfaces and loaded surfaces must pass. Serial: call on rank 0.
void check_boundary_groups(const RawMesh& raw, const std::vector<std::string>& names);

/// Pairs of surface groups expected to touch: the partition tries to keep both sides of an interface together.
using ContactHints = std::vector<std::array<std::string, 2>>;

/// Distributes the mesh (`raw` matters on rank 0 only) with DMPlex and the partitioner of -petscpartitioner_type
/// (default "metis", registered by this library), refines `refine` times uniformly, and builds this rank's arrays.
/// Collective.
Mesh distribute_mesh(MPI_Comm comm, const RawMesh& raw, const ContactHints& hints, int refine);

} // namespace amontons
