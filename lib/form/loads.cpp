#include "form/loads.hpp"

#include "base/error.hpp"
#include "math/bubble.hpp"
#include "math/reference_element.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace amontons {
namespace {

using Vector3 = Eigen::Vector3d;

/// Degree of the quadrature: a load that varies like the square of the shape functions is exact on a flat facet.
int load_degree(ElementType type) { return 3 * element_order(type) + 1; }

/// Place and directions of the element's coordinate lines at a point, padded with zeros to three dimensions.
struct Placed {
  Vector3 x = Vector3::Zero();
  Eigen::Matrix3d tangents = Eigen::Matrix3d::Zero(); // column j: ∂x/∂ξ_j
};

Placed place(const Mesh& mesh, const Tabulation& table, int q, std::span<const std::int32_t> nodes) {
  Placed placed;
  const int dim = element_dim(table.type);
  const auto values = table.value(q), gradients = table.gradient(q);
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    const auto X = mesh.position(nodes[a]);
    for (int i = 0; i < mesh.dim; ++i) {
      placed.x[i] += values[a] * X[i];
      for (int j = 0; j < dim; ++j)
        placed.tangents(i, j) += gradients[a * dim + j] * X[i];
    }
  }
  return placed;
}

/// Outward normal times the ratio of true to reference area (see FacetSet for the orientation).
Vector3 area_normal(const Placed& placed, int mesh_dim) {
  const Vector3 t = placed.tangents.col(0);
  if (mesh_dim == 2) return {t[1], -t[0], 0};
  return t.cross(Vector3(placed.tangents.col(1)));
}

Vector3 evaluate(const std::array<std::optional<Expression>, 3>& components, double time, std::span<const double> x) {
  Vector3 result = Vector3::Zero();
  for (int i = 0; i < 3; ++i)
    if (components[i]) result[i] = (*components[i])(time, x);
  return result;
}

/// Adds N_a times `force` to the nodal forces.
void spread(std::span<const std::int32_t> nodes, std::span<const double> values, const Vector3& force, int dim,
            std::span<double> forces) {
  for (std::size_t a = 0; a < nodes.size(); ++a)
    for (int i = 0; i < dim; ++i)
      forces[std::size_t(nodes[a]) * dim + i] += values[a] * force[i];
}

void add_surface_load(const Mesh& mesh, Space space, const SurfaceLoad& load, double time, std::span<double> forces) {
  const FacetSet& facets = mesh.surfaces.at(load.group);
  for (std::int32_t f = 0; f < facets.size(); ++f) {
    const auto nodes = facets.facet(f);
    const Tabulation& table = tabulation(facets.types[f], load_degree(facets.types[f]));
    for (int q = 0; q < table.rule->size(); ++q) {
      const Placed placed = place(mesh, table, q, nodes);
      const std::span<const double> x(placed.x.data(), mesh.dim);
      const Vector3 normal = area_normal(placed, mesh.dim);
      Vector3 force = evaluate(load.traction, time, x) * normal.norm();
      if (load.pressure) force -= (*load.pressure)(time, x) * normal;
      spread(nodes, table.value(q), table.rule->weights[q] * circumference(space, x[0]) * force, mesh.dim, forces);
    }
  }
}

/// Calls work(c, q, force) for each cell and quadrature point of the block, `force` the load times the volume that the
/// point stands for.
template <class Work>
void each_body_force(const Mesh& mesh, Space space, const CellBlock& block, const BodyLoad& load, double time,
                     Work&& work) {
  if (mesh.bodies[block.body] != load.body) return;
  const Tabulation& table = tabulation(block.type, load_degree(block.type));
  for (std::int32_t c = 0; c < block.size(); ++c)
    for (int q = 0; q < table.rule->size(); ++q) {
      Placed placed = place(mesh, table, q, block.cell(c));
      if (mesh.dim == 2) placed.tangents(2, 2) = 1; // unit thickness
      const std::span<const double> x(placed.x.data(), mesh.dim);
      const double volume = table.rule->weights[q] * placed.tangents.determinant() * circumference(space, x[0]);
      work(c, q, Vector3(volume * evaluate(load.force, time, x)));
    }
}

void add_body_load(const Mesh& mesh, Space space, const BodyLoad& load, double time, std::span<double> forces) {
  for (const auto& block : mesh.blocks) {
    const Tabulation& table = tabulation(block.type, load_degree(block.type));
    each_body_force(mesh, space, block, load, time, [&](std::int32_t c, int q, const Vector3& force) {
      spread(block.cell(c), table.value(q), force, mesh.dim, forces);
    });
  }
}

std::string unknown_name(const std::string& what, const std::string& name, const std::vector<std::string>& known) {
  const std::string match = nearest_match(name, known);
  return "the mesh has no " + what + " '" + name + "'" + (match.empty() ? "." : "; did you mean '" + match + "'?") +
         " It has " + (known.empty() ? "none" : join_names(known)) + ".";
}

} // namespace

std::vector<double> bubble_forces(const Mesh& mesh, Space space, const CellBlock& block,
                                  std::span<const BodyLoad> loads, double time) {
  std::vector<double> result(std::size_t(block.size()) * mesh.dim);
  const Quadrature& rule = quadrature(block.type, load_degree(block.type));
  for (const auto& load : loads)
    each_body_force(mesh, space, block, load, time, [&](std::int32_t c, int q, const Vector3& force) {
      for (int i = 0; i < mesh.dim; ++i)
        result[std::size_t(c) * mesh.dim + i] += bubble_value(block.type, rule.point(q)) * force[i];
    });
  return result;
}

LoadForm::LoadForm(const DofLayout& layout, Space space, std::vector<SurfaceLoad> surface, std::vector<BodyLoad> body,
                   std::vector<ResultantLoad> resultants)
    : layout_(layout), space_(space), surface_(std::move(surface)), body_(std::move(body)),
      resultants_(std::move(resultants)) {
  check_names();
}

void LoadForm::check_names() const {
  const Mesh& mesh = layout_.mesh();
  std::vector<std::string> errors, surfaces;
  for (const auto& [name, facets] : mesh.surfaces)
    surfaces.push_back(name);
  const auto check_components = [&](const auto& components, const std::string& name) {
    if (mesh.dim == 2 && components[2])
      errors.push_back("the load on '" + name + "' has a z component, but the space is two-dimensional; leave z out.");
  };
  for (const auto& load : surface_) {
    if (!mesh.surfaces.contains(load.group)) errors.push_back(unknown_name("surface group", load.group, surfaces));
    check_components(load.traction, load.group);
  }
  for (const auto& load : body_) {
    if (std::find(mesh.bodies.begin(), mesh.bodies.end(), load.body) == mesh.bodies.end())
      errors.push_back(unknown_name("body", load.body, mesh.bodies));
    check_components(load.force, load.body);
  }
  if (!errors.empty()) throw UserError(errors);
}

const std::vector<double>& LoadForm::nodal_forces(double time) {
  if (time_ == time) return forces_;
  const Mesh& mesh = layout_.mesh();
  forces_.assign(std::size_t(mesh.num_local()) * mesh.dim, 0.0);
  for (const auto& load : surface_)
    add_surface_load(mesh, space_, load, time, forces_);
  for (const auto& load : body_)
    add_body_load(mesh, space_, load, time, forces_);
  time_ = time;
  return forces_;
}

void LoadForm::add_residual(const State& state, Residual& residual) {
  const auto& forces = nodal_forces(state.time);
  const auto nodal = residual.nodal();
  for (std::size_t i = 0; i < forces.size(); ++i)
    nodal[i] -= forces[i];
  for (const auto& load : resultants_) {
    // Every rank knows the equation; its owner alone adds the force.
    const PetscInt equation = layout_.tied_equation(load.tied);
    if (equation < layout_.first_equation() || equation >= layout_.first_equation() + layout_.num_owned()) continue;
    const double force = -load.force(state.time);
    residual.add({&equation, 1}, {&force, 1});
  }
}

} // namespace amontons
