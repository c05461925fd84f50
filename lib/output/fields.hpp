// fields.h5 and fields.xdmf: what ParaView shows. Volume fields at the nodes, contact fields on the slave surfaces and
// at their quadrature points. It knows no contact and no material: the application hands over names and numbers.
#pragma once

#include "mesh/mesh.hpp"

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace amontons {

struct XdmfGrid;

/// Scalar: 1 component. Vector: dim. SymmetricTensor: the 4 (2D) or 6 (3D) of math/tensor.hpp, as stresses (true
/// shear).
enum class FieldKind { Scalar, Vector, SymmetricTensor };

/// A field at the nodes: num_local() x components numbers, up to date at ghosts.
struct NodalField {
  std::string name;
  FieldKind kind = FieldKind::Scalar;
  std::span<const double> values;
};

/// A scalar known at some vertices: values[i] at local node nodes[i]; every owned vertex of the surface should be
/// there, ghosts need not.
struct VertexField {
  std::string name;
  std::span<const std::int32_t> nodes;
  std::span<const double> values;
};

/// Fields of one contact pair on its slave surface. Nodes in the middle of edges and faces get the linear interpolation
/// of the corners (multipliers are linear). Vector fields of the volume (the displacement) are added by the writer.
struct SurfaceFields {
  std::string name;    // of the pair
  std::string surface; // name in Mesh::surfaces
  std::vector<VertexField> fields;
};

/// A quantity at this rank's points: values.size() == points x components (1 or 3). NaN: no value there.
struct PointField {
  std::string name;
  int components = 1;
  std::vector<double> values;
};

/// Fields of one contact pair at this rank's quadrature points.
struct PointFields {
  std::string name;                          // of the pair
  std::vector<std::array<double, 3>> places; // reference positions X
  std::vector<PointField> fields;
};

/// Everything to be written at one accepted state. Names and their order must be the same on all ranks.
struct FieldsStep {
  double time = 0.0;
  std::vector<NodalField> nodal;
  std::vector<SurfaceFields> surfaces;
  std::vector<PointFields> points;
};

/// Writes the time series. The mesh is written once; a step is on disk, and fields.xdmf valid, when write() returns, so
/// a user can look while the run goes on and has everything up to a crash.
///
/// fields.h5 holds /run<r>/mesh {coordinates, topology, body, rank}, /run<r>/surfaces/<pair> {coordinates, topology}
/// and /run<r>/step_<n> {<nodal field> ..., surfaces/<pair>/<field>, points/<pair>/{places, vertices, <field>}} with
/// the attribute `time`. Every restart in the same directory begins a new r, for its partition orders nodes and cells
/// in its own way.
class FieldsWriter {
 public:
  /// Starts the files in `directory`. With `resume_time` the steps up to that time stay, if there are any. Throws
  /// UserError when a file cannot be written or an existing one to go on with is damaged. `mesh` must outlive the
  /// writer. Collective.
  /// `stem`: the files' name without .h5 and .xdmf.
  FieldsWriter(const Mesh& mesh, const std::string& directory, const std::string& title,
               std::optional<double> resume_time = {}, const std::string& stem = "fields");

  /// Collective.
  void write(const FieldsStep& step);

 private:
  /// The part of a surface that is written once.
  struct Surface {
    std::vector<std::int32_t> nodes; // owned nodes of the surface, in the order of its rows
    std::int64_t num_nodes = 0, num_facets = 0, topology_size = 0; // global
  };

  void start_files(const std::string& title, std::optional<double> resume_time);
  void write_mesh();
  const Surface& surface(const std::string& pair, const std::string& name);
  class StepFile;
  XdmfGrid volume_grid(StepFile& out, const FieldsStep& step) const;
  XdmfGrid surface_grid(StepFile& out, const FieldsStep& step, const SurfaceFields& fields) const;
  XdmfGrid points_grid(StepFile& out, const PointFields& points) const;
  void append_xdmf(const std::string& step);

  const Mesh* mesh_;
  std::string h5_path_, xdmf_path_;
  std::string run_;                                // "/run0"
  int num_steps_ = 0;                              // of this run
  long xdmf_end_ = 0;                              // where the tail begins (rank 0)
  std::int64_t num_cells_ = 0, topology_size_ = 0; // global
  std::map<std::string, Surface> surfaces_;
};

/// A name as HDF5 paths can hold it: everything but letters, digits, '_', '-' and '.' becomes '_'.
std::string dataset_name(const std::string& name);

} // namespace amontons
