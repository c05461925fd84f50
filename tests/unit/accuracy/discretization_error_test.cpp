// The estimate of the discretization error against exact errors: of elastic problems with closed-form solutions, solved
// on every element type in every space.
#include "../form/dense_system.hpp"
#include "accuracy/discretization_error.hpp"
#include "form/bulk.hpp"
#include "form/loads.hpp"
#include "material/elastic.hpp"

#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;

namespace {

const Elastic material{100.0, 0.3};

/// The box of unit sides from x = 1 on, which in axisymmetric space is a ring. Lamé's field is too steep there for the
/// few hexahedra of order 2 that a dense solver can do: they start at x = 2.
Mesh box(MPI_Comm comm, ElementType type, int n) {
  const double start = type == ElementType::Hexahedron27 ? 2.0 : 1.0;
  return enclosed(box_mesh(comm, type, {n, n, n}, [start](auto p) -> std::array<double, 3> {
    return {start + p[0], p[1], p[2]};
  }));
}

/// Lamé's field u_r = A r + B / r about the origin (about the axis in solid space), without a body force.
constexpr double A = 0.3, B = 1.0;

Field lame_displacement(Space space) {
  return [space](std::span<const double> x) -> std::array<double, 3> {
    const double y = space == Space::Axisymmetric ? 0.0 : x[1], factor = A + B / (x[0] * x[0] + y * y);
    return {factor * x[0], factor * y, 0};
  };
}

/// σ = 2 (λ + G) A 1 + 2 G B / r² (1 - 2 n ⊗ n) in the plane of r and θ, 2 λ A along the axis (0 in plane stress).
Eigen::VectorXd lame_stress(Space space, const Eigen::VectorXd& x) {
  const Lame lame = lame_constants(material, space);
  const bool ring = space == Space::Axisymmetric;
  const double y = ring ? 0.0 : x[1], r2 = x[0] * x[0] + y * y;
  const double even = 2 * (lame.lambda + lame.G) * A, odd = 2 * lame.G * B / r2;
  const double axial = space == Space::PlaneStress ? 0.0 : 2 * lame.lambda * A;
  Eigen::VectorXd stress = Eigen::VectorXd::Zero(x.size() == 2 ? 4 : 6);
  if (ring) {
    stress << even - odd, axial, even + odd, 0.0;
  } else {
    stress[0] = even + odd * (1 - 2 * x[0] * x[0] / r2);
    stress[1] = even + odd * (1 - 2 * y * y / r2);
    stress[2] = axial;
    stress[3] = -2 * odd * x[0] * y / r2;
  }
  return stress;
}

/// s : C⁻¹ : s. In plane stress λ is that of the in-plane law, and only two normal stresses count.
double complementary(Space space, const Eigen::VectorXd& s) {
  const Lame lame = lame_constants(material, space);
  const int normal = space == Space::PlaneStress ? 2 : 3;
  const double trace = s.head(normal).sum();
  const double squares = s.head(normal).squaredNorm() + 2 * s.tail(s.size() - 3).squaredNorm();
  return (squares - lame.lambda / (normal * lame.lambda + 2 * lame.G) * trace * trace) / (2 * lame.G);
}

/// The points of a cell where the stresses of a solution are compared with the exact ones, and the stresses there.
struct Points {
  Eigen::MatrixXd places, stress;
  Eigen::VectorXd weights;
};

/// Stress of simplices is constant (order 1) or linear (order 2) in x: it is continued from the stiffness's points,
/// which are too few, to those of a rule of degree 6. All sides are straight.
Points comparison(const Mesh& mesh, const PointBatch& batch, std::int32_t c) {
  const int own = batch.table->rule->size(), dim = mesh.dim;
  const auto components = static_cast<Eigen::Index>(batch.stress.size() / batch.weights.size());
  const auto nodes = batch.block->cell(batch.first_cell + c);
  const auto places = [&](const Tabulation& table) {
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(table.rule->size(), dim);
    for (int q = 0; q < x.rows(); ++q)
      for (std::size_t a = 0; a < nodes.size(); ++a)
        for (int i = 0; i < dim; ++i)
          x(q, i) += table.value(q)[a] * mesh.position(nodes[a])[i];
    return x;
  };
  Points result{places(*batch.table), Eigen::MatrixXd(own, components), Eigen::VectorXd(own)};
  for (int q = 0; q < own; ++q) {
    result.weights[q] = batch.weights[c * own + q];
    for (Eigen::Index i = 0; i < components; ++i)
      result.stress(q, i) = batch.stress[(c * own + q) * components + i];
  }
  const int order = element_order(batch.block->type);
  const bool few = own == 1 || (order == 2 && own == dim + 1);
  if (!few) return result;
  const Tabulation& fine = tabulation(batch.block->type, 6);
  const auto linear = [&](const Eigen::MatrixXd& x) {
    Eigen::MatrixXd terms = Eigen::MatrixXd::Ones(x.rows(), order == 1 ? 1 : 1 + dim);
    if (order == 2) terms.rightCols(dim) = x;
    return terms;
  };
  const Eigen::MatrixXd x = places(fine);
  const Eigen::Map<const Eigen::VectorXd> weights(fine.rule->weights.data(), x.rows());
  result.stress = linear(x) * linear(result.places).colPivHouseholderQr().solve(result.stress).eval();
  result.weights = weights * (result.weights.sum() / weights.sum());
  result.places = x;
  return result;
}

struct Errors {
  double exact, estimated;
};

/// Lamé's field prescribed all around a box of n cells a side.
Errors errors(const ElementCase& scene, int n) {
  const Mesh mesh = box(PETSC_COMM_SELF, scene.type, n);
  const DofLayout layout(mesh, {}, {});
  BulkForm solid(layout, scene.space, {material});
  LoadForm loads(layout, scene.space, {}, {}, {});
  const Field field = lame_displacement(scene.space);
  std::map<Eigen::Index, double> prescribed;
  for (const auto& [group, nodes] : mesh.node_groups)
    for (const auto node : nodes)
      for (int i = 0; mesh.surfaces.contains(group) && i < mesh.dim; ++i)
        prescribed[node * mesh.dim + i] = field(mesh.position(node))[i];
  const Eigen::VectorXd u = solve_linear(layout, solid, loads, prescribed);
  double exact = 0;
  solid.for_each_batch(state_of(u), [&](const PointBatch& batch) {
    for (std::int32_t c = 0; c < batch.num_cells; ++c) {
      const Points points = comparison(mesh, batch, c);
      for (Eigen::Index q = 0; q < points.weights.size(); ++q)
        exact += points.weights[q] *
                 complementary(scene.space, points.stress.row(q).transpose() -
                                                lame_stress(scene.space, points.places.row(q).transpose()));
    }
  });
  return {std::sqrt(exact), estimate_discretization_error(solid, mesh, state_of(u), {}).error};
}

/// A field that the elements reproduce and that is in equilibrium: constant strain for order 1 and axisymmetry, pure
/// bending, with stress along x in proportion to y, for order 2.
Field reproduced(Space space, int order) {
  const double nu = space == Space::PlaneStrain ? material.poisson / (1 - material.poisson) : material.poisson;
  return [space, order, nu](std::span<const double> x) -> std::array<double, 3> {
    const double z = x.size() > 2 ? x[2] : 0.0;
    if (space == Space::Axisymmetric) return {0.02 * x[0], 0.01 * x[1], 0};
    if (order == 1) return {0.02 * x[0] - 0.01 * x[1], 0.03 * x[0] + 0.01 * x[1] + 0.02 * z, 0.01 * z};
    return {x[0] * x[1], -0.5 * (x[0] * x[0] + nu * (x[1] * x[1] - z * z)), -nu * x[1] * z};
  };
}

} // namespace

TEST_CASE("estimated error: zero where the elements have the exact solution, on any number of ranks") {
  for (const auto& scene : element_cases) {
    CAPTURE(int(scene.type));
    CAPTURE(int(scene.space));
    const Mesh mesh = box(PETSC_COMM_WORLD, scene.type, 3);
    const DofLayout layout(mesh, {}, {});
    BulkForm solid(layout, scene.space, {material});
    const Eigen::VectorXd u = nodal_values(mesh, reproduced(scene.space, element_order(scene.type)));
    const auto error = estimate_discretization_error(solid, mesh, state_of(u), {});
    CHECK(error.solution > 0.01);
    CHECK(error.relative() < 1e-9);
  }
}

TEST_CASE("estimated error: between half and twice the exact one, with the order of the element") {
  for (const auto& scene : element_cases) {
    CAPTURE(int(scene.type));
    CAPTURE(int(scene.space));
    const int order = element_order(scene.type), dim = element_dim(scene.type);
    const int n = dim == 2 ? 4 : 2, finer = dim == 2 ? 8 : (order == 1 ? 5 : 3);
    const Errors coarse = errors(scene, n), fine = errors(scene, finer);
    const double effectivity = fine.estimated / fine.exact;
    CAPTURE(effectivity);
    CHECK(coarse.exact > 1e-3);
    CHECK(effectivity > 0.5);
    CHECK(effectivity < 2.0);
    CHECK(std::log(coarse.estimated / fine.estimated) / std::log(double(finer) / n) > order - 0.35);
  }
}

TEST_CASE("estimated error: the same on any number of ranks") {
  for (const auto& scene : element_cases) {
    CAPTURE(int(scene.type));
    CAPTURE(int(scene.space));
    const auto estimate = [&](MPI_Comm comm) {
      const Mesh mesh = box(comm, scene.type, 4);
      const DofLayout layout(mesh, {}, {});
      BulkForm solid(layout, scene.space, {material});
      const Eigen::VectorXd u = nodal_values(mesh, lame_displacement(scene.space));
      return estimate_discretization_error(solid, mesh, state_of(u), {});
    };
    const auto alone = estimate(PETSC_COMM_SELF), shared = estimate(PETSC_COMM_WORLD);
    CHECK(alone.error > 1e-3);
    CHECK(shared.error == doctest::Approx(alone.error).epsilon(1e-9));
    CHECK(shared.solution == doctest::Approx(alone.solution).epsilon(1e-9));
  }
}

TEST_CASE("edge of contact: where the status changes, and the part of the error around it") {
  for (const auto type : {ElementType::Triangle3, ElementType::Quadrilateral9, ElementType::Hexahedron8}) {
    CAPTURE(int(type));
    const Mesh mesh = box(PETSC_COMM_WORLD, type, 6);
    const FacetSet& bottom = mesh.surfaces.at("y-");
    ContactSamples samples; // in contact at x < 1.5
    for (std::int32_t f = 0; f < bottom.size(); ++f) {
      double middle = 0;
      for (int a = 0; a < num_vertices(bottom.types[f]); ++a)
        middle += mesh.position(bottom.facet(f)[a])[0] / num_vertices(bottom.types[f]);
      samples.facet.push_back(f);
      samples.facet_size.push_back(1.0 / 6);
      samples.status.push_back(middle < 1.5 ? ContactStatus::Slip : ContactStatus::Open);
    }
    const std::vector<std::string> slaves = {"y-"};
    Eigen::VectorXd u = Eigen::VectorXd::Zero(mesh.num_local() * mesh.dim);
    const auto edge = contact_edge(mesh, {u.data(), std::size_t(u.size())}, slaves, {&samples, 1});
    CHECK(edge.size() == (mesh.dim == 2 ? 1 : 7));
    for (const auto& point : edge) {
      CHECK(point.place[0] == doctest::Approx(1.5));
      CHECK(std::abs(point.place[1]) < 1e-12);
      CHECK(point.size == doctest::Approx(1.0 / 6));
    }
    const auto share = [&](double x, double y) { // of the error of a kink at this place
      const DofLayout layout(mesh, {}, {});
      const Space space = mesh.dim == 2 ? Space::PlaneStrain : Space::Solid;
      BulkForm solid(layout, space, {material});
      const auto kink = nodal_values(mesh, [x, y](auto place) -> std::array<double, 3> {
        const double distance = std::hypot(place[0] - x, place[1] - y);
        return {0, 1e-3 * std::max(0.0, 1.0 / 6 - distance), 0};
      });
      return estimate_discretization_error(solid, mesh, state_of(kink), edge).edge_share();
    };
    CHECK(share(1.5, 0.0) > 0.7);
    CHECK(share(1.0, 1.0) < 1e-6);
  }
}
