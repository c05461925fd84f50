#include "output/fields.hpp"

#include "base/error.hpp"
#include "base/log.hpp"
#include "math/reference_element.hpp"
#include "output/hdf5_file.hpp"
#include "output/node_exchange.hpp"
#include "output/text_file.hpp"
#include "output/xdmf.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <numeric>

namespace amontons {

namespace {

constexpr double no_value = -std::numeric_limits<double>::infinity();
const char* const tensor_components = "xx yy zz xy yz zx";

std::int64_t sum_over_ranks(MPI_Comm comm, std::int64_t mine) {
  std::int64_t sum = 0;
  MPI_Allreduce(&mine, &sum, 1, MPI_INT64_T, MPI_SUM, comm);
  return sum;
}

/// How many rows the ranks before this one have.
std::int64_t first_row(MPI_Comm comm, std::size_t rows) {
  const auto mine = std::int64_t(rows);
  std::int64_t first = 0;
  MPI_Exscan(&mine, &first, 1, MPI_INT64_T, MPI_SUM, comm);
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank == 0 ? 0 : first; // MPI leaves it undefined on rank 0
}

/// XDMF wants three coordinates, also of plane meshes.
std::vector<double> coordinates_3d(const Mesh& mesh, std::span<const std::int32_t> nodes) {
  std::vector<double> values;
  values.reserve(3 * nodes.size());
  for (const auto node : nodes) {
    const auto place = mesh.position(node);
    for (std::size_t i = 0; i < 3; ++i)
      values.push_back(i < place.size() ? place[i] : 0.0);
  }
  return values;
}

std::vector<std::int32_t> owned_nodes(const Mesh& mesh) {
  std::vector<std::int32_t> nodes(mesh.num_owned);
  std::iota(nodes.begin(), nodes.end(), 0);
  return nodes;
}

/// Announcement and nodes of one element as a Mixed topology has them; `number` gives a node's row in the geometry.
template <class Number>
void append_element(std::vector<PetscInt>& topology, ElementType type, std::span<const std::int32_t> nodes,
                    Number&& number) {
  for (const int code : xdmf_announcement(type))
    topology.push_back(code);
  for (const int k : xdmf_order(type))
    topology.push_back(number(nodes[k]));
}

int components_in_file(FieldKind kind) { return kind == FieldKind::Scalar ? 1 : kind == FieldKind::Vector ? 3 : 6; }
/// "Matrix" for tensors: ParaView names six components XX YY ZZ XY YZ XZ, which is our order; XDMF's own "Tensor6" has
/// another order, which one of ParaView's two readers turns into nine components and the other mislabels.
const char* xdmf_type(int components) { return components == 1 ? "Scalar" : components == 3 ? "Vector" : "Matrix"; }

/// Rows of a field in the file's components, zero where a plane problem has none: three of a vector, six of a tensor.
std::vector<double> rows_of(const NodalField& field, int dim, std::span<const std::int32_t> nodes) {
  const int given = field.kind == FieldKind::Scalar ? 1 : field.kind == FieldKind::Vector ? dim : dim == 2 ? 4 : 6;
  const int written = components_in_file(field.kind);
  std::vector<double> rows;
  rows.reserve(nodes.size() * written);
  for (const auto node : nodes)
    for (int k = 0; k < written; ++k)
      rows.push_back(k < given ? field.values[std::size_t(node) * given + k] : 0.0);
  return rows;
}

/// A vertex field at all local nodes of a surface: given at owned vertices, carried to ghosts, interpolated linearly to
/// nodes in the middle of this rank's facets and from there to the owners of these. Collective.
std::vector<double> on_surface_nodes(const Mesh& mesh, const FacetSet& facets, const VertexField& field) {
  std::vector<double> values(mesh.num_local(), no_value);
  for (std::size_t i = 0; i < field.nodes.size(); ++i)
    values[field.nodes[i]] = field.values[i];
  NodeExchange exchange(mesh);
  exchange.to_ghosts(values);
  for (std::int32_t f = 0; f < facets.size(); ++f) {
    const ElementType type = facets.types[f];
    const auto nodes = facets.facet(f);
    const int corners = num_vertices(type), dim = element_dim(type);
    for (int a = corners; a < num_nodes(type); ++a) {
      std::array<double, 8> shape{};
      shape_values(linear_element(type), reference_nodes(type).subspan(std::size_t(a) * dim, dim),
                   std::span(shape).first(corners));
      double value = 0.0;
      for (int b = 0; b < corners; ++b)
        if (shape[b] != 0.0) value += shape[b] * values[nodes[b]];
      values[nodes[a]] = value;
    }
  }
  exchange.largest_to_owners(values);
  for (auto& value : values)
    if (!std::isfinite(value)) value = std::numeric_limits<double>::quiet_NaN();
  return values;
}

/// A dataset as the XDMF file beside the HDF5 file refers to it.
std::string link(const std::string& h5_path, const std::string& dataset) {
  return std::filesystem::path(h5_path).filename().string() + ":" + dataset;
}

} // namespace

std::string dataset_name(const std::string& name) {
  std::string result = name;
  for (auto& c : result)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-' && c != '.') c = '_';
  return result;
}

FieldsWriter::FieldsWriter(const Mesh& mesh, const std::string& directory, const std::string& title,
                           std::optional<double> resume_time, const std::string& stem)
    : mesh_(&mesh), h5_path_(directory + "/" + stem + ".h5"), xdmf_path_(directory + "/" + stem + ".xdmf") {
  start_files(title, resume_time);
  write_mesh();
}

void FieldsWriter::start_files(const std::string& title, std::optional<double> resume_time) {
  int resumes = 0;
  on_root(mesh_->comm, [&] {
    namespace fs = std::filesystem;
    std::string kept;
    if (resume_time && fs::exists(h5_path_) && fs::exists(xdmf_path_)) {
      if (!is_sound_hdf5(h5_path_))
        throw UserError(
            "The fields " + h5_path_ +
            " are damaged, so that a restart cannot go on with them. Restart into another directory with --out.");
      kept = xdmf_steps_until(read_text(xdmf_path_, "the description of the fields"), *resume_time).text;
      resumes = 1;
    }
    const std::string begin = xdmf_head(title) + kept;
    write_atomically(xdmf_path_, begin + xdmf_tail());
    xdmf_end_ = static_cast<long>(begin.size());
  });
  MPI_Bcast(&resumes, 1, MPI_INT, 0, mesh_->comm);
  Hdf5File file(mesh_->comm, h5_path_, resumes ? FileUse::Append : FileUse::Create);
  int run = 0;
  while (resumes && file.has_group("/run" + std::to_string(run)))
    ++run;
  run_ = "/run" + std::to_string(run);
  file.write_attribute(run_, "dim", std::int64_t(mesh_->dim));
  std::string bodies;
  for (const auto& body : mesh_->bodies)
    bodies += (bodies.empty() ? "" : "\n") + body;
  file.write_attribute(run_, "bodies", bodies);
  file.finish();
}

void FieldsWriter::write_mesh() {
  int rank = 0;
  MPI_Comm_rank(mesh_->comm, &rank);
  std::vector<PetscInt> topology, bodies;
  for (const auto& block : mesh_->blocks)
    for (std::int32_t c = 0; c < block.size(); ++c) {
      append_element(topology, block.type, block.cell(c),
                     [&](std::int32_t node) { return static_cast<PetscInt>(mesh_->global_node(node)); });
      bodies.push_back(block.body);
    }
  num_cells_ = sum_over_ranks(mesh_->comm, std::int64_t(bodies.size()));
  topology_size_ = sum_over_ranks(mesh_->comm, std::int64_t(topology.size()));
  Hdf5File file(mesh_->comm, h5_path_, FileUse::Append);
  file.write(run_ + "/mesh/coordinates", 3, coordinates_3d(*mesh_, owned_nodes(*mesh_)));
  file.write(run_ + "/mesh/topology", topology);
  file.write(run_ + "/mesh/body", bodies);
  file.write(run_ + "/mesh/rank", std::vector<PetscInt>(bodies.size(), rank));
  file.finish();
}

const FieldsWriter::Surface& FieldsWriter::surface(const std::string& pair, const std::string& name) {
  const auto known = surfaces_.find(pair);
  if (known != surfaces_.end()) return known->second;
  // A node of the surface may belong to a rank that has none of its facets, so that its owner must be told. Then the
  // owners number their nodes and tell the ranks that have the facets.
  const FacetSet& facets = mesh_->surfaces.at(name);
  NodeExchange exchange(*mesh_);
  std::vector<double> marks(mesh_->num_local(), 0.0), numbers(mesh_->num_local(), -1.0);
  for (const auto node : facets.nodes)
    marks[node] = 1.0;
  exchange.largest_to_owners(marks);
  Surface result;
  for (std::int32_t node = 0; node < mesh_->num_owned; ++node)
    if (marks[node] > 0.0) result.nodes.push_back(node);
  const auto mine = std::int64_t(result.nodes.size());
  const std::int64_t first = first_row(mesh_->comm, result.nodes.size());
  for (std::int64_t i = 0; i < mine; ++i)
    numbers[result.nodes[i]] = double(first + i);
  exchange.to_ghosts(numbers);

  std::vector<PetscInt> topology;
  for (std::int32_t f = 0; f < facets.size(); ++f)
    append_element(topology, facets.types[f], facets.facet(f),
                   [&](std::int32_t node) { return static_cast<PetscInt>(numbers[node]); });
  result.num_nodes = sum_over_ranks(mesh_->comm, mine);
  result.num_facets = sum_over_ranks(mesh_->comm, facets.size());
  result.topology_size = sum_over_ranks(mesh_->comm, std::int64_t(topology.size()));
  Hdf5File file(mesh_->comm, h5_path_, FileUse::Append);
  const std::string group = run_ + "/surfaces/" + dataset_name(pair);
  file.write(group + "/coordinates", 3, coordinates_3d(*mesh_, result.nodes));
  file.write(group + "/topology", topology);
  file.finish();
  return surfaces_.emplace(pair, std::move(result)).first->second;
}

/// The grids of one step under construction: each dataset written is described at once.
class FieldsWriter::StepFile {
 public:
  StepFile(MPI_Comm comm, const std::string& path, std::string group)
      : h5_path_(path), file_(comm, path, FileUse::Append), group_(std::move(group)) {}

  Hdf5File& file() { return file_; }
  const std::string& group() const { return group_; }

  /// Writes `part` as group()/`below`/name and lists it in `grid`.
  void add(XdmfGrid& grid, const std::string& below, const std::string& name, int components, std::int64_t rows,
           std::span<const double> part) {
    const std::string path = group_ + below + "/" + dataset_name(name);
    file_.write(path, components, part);
    grid.attributes.push_back({name, xdmf_type(components), "Node", {link(h5_path_, path), rows, components}});
  }

 private:
  std::string h5_path_;
  Hdf5File file_;
  std::string group_;
};

XdmfGrid FieldsWriter::points_grid(StepFile& out, const PointFields& points) const {
  XdmfGrid grid;
  grid.name = points.name + " points";
  grid.num_cells = sum_over_ranks(mesh_->comm, std::int64_t(points.places.size()));
  const std::string below = "/points/" + dataset_name(points.name);
  std::vector<double> places;
  for (const auto& place : points.places)
    places.insert(places.end(), place.begin(), place.end());
  out.file().write(out.group() + below + "/places", 3, places);
  grid.geometry = {link(h5_path_, out.group() + below + "/places"), grid.num_cells, 3};
  // One of ParaView's two readers shows no vertex unless told which point it is.
  std::vector<PetscInt> vertices(points.places.size());
  std::iota(vertices.begin(), vertices.end(), static_cast<PetscInt>(first_row(mesh_->comm, vertices.size())));
  out.file().write(out.group() + below + "/vertices", vertices);
  grid.topology = {link(h5_path_, out.group() + below + "/vertices"), grid.num_cells, 1, true};
  grid.is_cloud = true;
  for (const auto& field : points.fields)
    out.add(grid, below, field.name, field.components, grid.num_cells, field.values);
  return grid;
}

XdmfGrid FieldsWriter::volume_grid(StepFile& out, const FieldsStep& step) const {
  const std::string mesh = link(h5_path_, run_ + "/mesh/");
  XdmfGrid grid;
  grid.name = "volume";
  grid.num_cells = num_cells_;
  grid.topology = {mesh + "topology", topology_size_, 1, true};
  grid.geometry = {mesh + "coordinates", mesh_->num_global, 3};
  grid.attributes = {{"body", "Scalar", "Cell", {mesh + "body", num_cells_, 1, true}},
                     {"rank", "Scalar", "Cell", {mesh + "rank", num_cells_, 1, true}}};
  const auto nodes = owned_nodes(*mesh_);
  for (const auto& field : step.nodal)
    out.add(grid, "", field.name, components_in_file(field.kind), mesh_->num_global, rows_of(field, mesh_->dim, nodes));
  return grid;
}

XdmfGrid FieldsWriter::surface_grid(StepFile& out, const FieldsStep& step, const SurfaceFields& fields) const {
  const Surface& numbering = surfaces_.at(fields.name);
  const std::string below = "/surfaces/" + dataset_name(fields.name);
  const std::string fixed = link(h5_path_, run_ + below);
  XdmfGrid grid;
  grid.name = fields.name;
  grid.num_cells = numbering.num_facets;
  grid.topology = {fixed + "/topology", numbering.topology_size, 1, true};
  grid.geometry = {fixed + "/coordinates", numbering.num_nodes, 3};
  for (const auto& field : step.nodal)
    if (field.kind == FieldKind::Vector)
      out.add(grid, below, field.name, 3, numbering.num_nodes, rows_of(field, mesh_->dim, numbering.nodes));
  for (const auto& field : fields.fields) {
    const auto values = on_surface_nodes(*mesh_, mesh_->surfaces.at(fields.surface), field);
    std::vector<double> part;
    for (const auto node : numbering.nodes)
      part.push_back(values[node]);
    out.add(grid, below, field.name, 1, numbering.num_nodes, part);
  }
  return grid;
}

void FieldsWriter::write(const FieldsStep& step) {
  for (const auto& fields : step.surfaces)
    surface(fields.name, fields.surface);
  const std::string group = run_ + formatted("/step_%06d", num_steps_++);
  std::vector<XdmfGrid> grids;
  StepFile out(mesh_->comm, h5_path_, group);
  out.file().write_attribute(group, "time", step.time);
  out.file().write_attribute(group, "tensor_components", std::string(tensor_components));
  grids.push_back(volume_grid(out, step));
  for (const auto& fields : step.surfaces)
    if (surfaces_.at(fields.name).num_facets > 0) grids.push_back(surface_grid(out, step, fields));
  for (const auto& points : step.points) {
    auto grid = points_grid(out, points);
    if (grid.num_cells > 0) grids.push_back(std::move(grid));
  }
  out.file().finish();
  append_xdmf(xdmf_step(step.time, grids));
}

void FieldsWriter::append_xdmf(const std::string& step) {
  on_root(mesh_->comm, [&] {
    // The new step overwrites the tail and brings its own, in one write: the file is valid before and after.
    const std::string text = step + xdmf_tail();
    std::FILE* file = std::fopen(xdmf_path_.c_str(), "r+");
    const bool written = file && std::setvbuf(file, nullptr, _IOFBF, text.size() + 1) == 0 &&
                         std::fseek(file, xdmf_end_, SEEK_SET) == 0 &&
                         std::fwrite(text.data(), 1, text.size(), file) == text.size();
    const bool closed = file && std::fclose(file) == 0;
    if (!written || !closed)
      throw UserError("The file " + xdmf_path_ + " cannot be written: " + std::strerror(errno) + ".");
    xdmf_end_ += static_cast<long>(step.size());
  });
}

} // namespace amontons
