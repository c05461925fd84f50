// Internal forces and tangent at finite strain, for every element in every space: consistency with the energy, patch
// test, rigid motions, the limit of small strain, plastic memory, failures.
#include "dense_system.hpp"
#include "form/bulk.hpp"
#include "form/finite_bulk.hpp"
#include "material/elastic.hpp"

#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;

namespace {

constexpr Elastic soft{7.0, 0.3};

/// A skewed and smoothly bent box at x > 0.
std::array<double, 3> bent(std::array<double, 3> p) {
  const auto [x, y, z] = p;
  return {1 + x + 0.2 * y + 0.1 * std::sin(2 * x + 3 * y + z), y - 0.15 * x + 0.1 * std::sin(3 * x - y + 2 * z),
          z + 0.1 * x * y - 0.08 * std::sin(2 * y + x)};
}

Mesh small_mesh(ElementType type, std::array<int, 3> counts = {2, 1, 1}) {
  Mesh mesh = box_mesh(PETSC_COMM_SELF, type, counts, bent);
  if (type == ElementType::Tetrahedron10) straighten(mesh);
  return mesh;
}

ElasticPlastic metal() {
  return {.elastic = {200.0, 0.3}, .hardening = LinearHardening{.yield = 1.0, .H = 5.0}, .kinematic = {}, .rate = {}};
}

/// A large homogeneous deformation that the space allows, as displacement: stretches of 1.3 and 0.8 and shear; in
/// axisymmetric space r and z are stretched.
std::array<double, 3> homogeneous(Space space, std::span<const double> X) {
  if (space == Space::Axisymmetric) return {0.3 * X[0], -0.2 * X[1] + 0.1, 0};
  const double z = space == Space::Solid ? X[2] : 0;
  return {0.3 * X[0] + 0.4 * X[1] - 0.1 * z, 0.1 * X[0] - 0.2 * X[1] + 0.2 * z, 0.15 * X[0] - 0.1 * z};
}

Tensor homogeneous_gradient(Space space) {
  Tensor F = Tensor::Identity();
  if (space == Space::Axisymmetric) {
    F.diagonal() << 1.3, 0.8, 1.3;
    return F;
  }
  F.topLeftCorner<2, 2>() << 1.3, 0.4, 0.1, 0.8;
  if (space == Space::Solid) F << 1.3, 0.4, -0.1, 0.1, 0.8, 0.2, 0.15, 0, 0.9;
  return F;
}

std::vector<bool> outer_nodes(const Mesh& mesh) {
  std::vector<bool> outside(mesh.num_local());
  for (const auto& [name, nodes] : mesh.node_groups)
    for (const auto node : nodes)
      outside[node] = true;
  return outside;
}

/// The tangent's column for each unknown by central differences of the residual.
Eigen::MatrixXd differences(const DofLayout& layout, Form& form, const Eigen::VectorXd& u, double time) {
  constexpr double h = 1e-6;
  Eigen::MatrixXd K(u.size(), u.size());
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    Eigen::VectorXd up = u, down = u;
    up[i] += h;
    down[i] -= h;
    K.col(i) = (residual_of(layout, form, up, time) - residual_of(layout, form, down, time)) / (2 * h);
  }
  return K;
}

/// Are forces the derivative of the energy, and is the tangent that of the forces, at `u`?
void check_derivatives(const DofLayout& layout, FiniteBulkForm& form, const Eigen::VectorXd& u, bool has_energy) {
  const Eigen::VectorXd v = random_vector(u.size(), 2), force = residual_of(layout, form, u, 1.0);
  DenseTangent tangent(layout.num_global());
  form.add_tangent(state_of(u, 1.0), tangent);
  const Eigen::MatrixXd& K = tangent.matrix;
  REQUIRE(force.norm() > 0.01);
  REQUIRE((K * v).norm() > 0.1);
  if (form.tangent_is_symmetric()) CHECK((K - K.transpose()).norm() < 1e-12 * K.norm());
  CHECK((differences(layout, form, u, 1.0) - K).norm() < 1e-7 * K.norm());
  const auto remainder = [&](double h) {
    return (residual_of(layout, form, u + h * v, 1.0) - force - h * (K * v)).norm();
  };
  REQUIRE(remainder(1e-3) > 1e-8 * force.norm());
  CHECK(std::log2(remainder(2e-4) / remainder(1e-4)) == doctest::Approx(2).epsilon(0.02));
  CHECK(form.internal_work(state_of(u, 1.0)) == doctest::Approx(force.dot(u)).epsilon(1e-11));
  if (!has_energy) return;
  const auto energy = [&](double h) { return form.stored_energy(state_of(u + h * v, 1.0)); };
  const double h = 1e-3, slope = (8 * (energy(h) - energy(-h)) - (energy(2 * h) - energy(-2 * h))) / (12 * h);
  CHECK(std::abs(slope - force.dot(v)) < 1e-8 * force.norm() * v.norm());
}

} // namespace

TEST_CASE("finite: forces are the derivative of the energy, the tangent that of the forces") {
  for (const auto& [type, space] : finite_cases())
    for (const FiniteLaw& law : {FiniteLaw{NeoHookean{soft}}, FiniteLaw{Hencky{Elastic{7.0, 0.49}}}}) {
      CAPTURE(int(type));
      CAPTURE(int(space));
      CAPTURE(law.index());
      const Mesh mesh = small_mesh(type, {1, 1, 1});
      const DofLayout layout(mesh, {}, {});
      FiniteBulkForm form(layout, space, {law});
      check_derivatives(layout, form, 0.05 * random_vector(layout.num_global(), 1), true);
    }
}

TEST_CASE("finite: the tangent of plastic flow is that of its forces, also after earlier flow") {
  for (const auto& [type, space] : finite_cases()) {
    CAPTURE(int(type));
    CAPTURE(int(space));
    const Mesh mesh = small_mesh(type, {1, 1, 1});
    const DofLayout layout(mesh, {}, {});
    FiniteBulkForm form(layout, space, {FinitePlastic{metal()}});
    const Eigen::VectorXd u = 0.03 * random_vector(layout.num_global(), 1);
    form.commit(state_of(u, 0.5));
    REQUIRE(form.dissipated_energy(state_of(u, 0.5)) > 0.0);
    check_derivatives(layout, form, 2.0 * u + 0.01 * random_vector(u.size(), 3), false);
  }
}

TEST_CASE("finite: a homogeneous deformation has the law's stress everywhere and no force inside") {
  for (const auto& [type, space] : finite_cases()) {
    CAPTURE(int(type));
    CAPTURE(int(space));
    const Mesh mesh = small_mesh(type, {3, 2, 2});
    const DofLayout layout(mesh, {}, {});
    const NeoHookean law{soft};
    FiniteBulkForm form(layout, space, {law});
    const Eigen::VectorXd u = nodal_values(mesh, [&](auto X) { return homogeneous(space, X); });
    const Eigen::VectorXd force = residual_of(layout, form, u);
    const auto outside = outer_nodes(mesh);
    double inside = 0;
    for (std::int32_t node = 0; node < mesh.num_local(); ++node)
      if (!outside[node]) inside = std::max(inside, force.segment(node * mesh.dim, mesh.dim).cwiseAbs().maxCoeff());
    CHECK(std::count(outside.begin(), outside.end(), false) > 0);
    CHECK(force.cwiseAbs().maxCoeff() > 0.01);
    CHECK(inside < 1e-12 * force.cwiseAbs().maxCoeff());

    const Tensor F = homogeneous_gradient(space), sigma = law.piola(F) * F.transpose() / F.determinant();
    const std::array<double, 6> wanted = {sigma(0, 0), sigma(1, 1), sigma(2, 2), sigma(0, 1), sigma(1, 2), sigma(2, 0)};
    const std::size_t components = space == Space::Solid ? 6 : 4;
    form.for_each_batch(state_of(u), [&](const PointBatch& batch) {
      for (std::size_t i = 0; i < batch.stress.size(); ++i)
        REQUIRE(batch.stress[i] == doctest::Approx(wanted[i % components]).epsilon(1e-11));
      for (const double J : batch.scalars)
        REQUIRE(J == doctest::Approx(F.determinant()).epsilon(1e-12));
    });
  }
}

TEST_CASE("finite: a rotated body has no stress, and rotation turns forces and keeps energies") {
  Tensor R;
  R = Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, -2, 3).normalized());
  for (const auto& [type, space] : finite_cases()) {
    if (space == Space::Axisymmetric) continue;
    CAPTURE(int(type));
    if (space == Space::PlaneStrain) R = Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ());
    const Mesh mesh = small_mesh(type, {1, 1, 1});
    const DofLayout layout(mesh, {}, {});
    FiniteBulkForm form(layout, space, {NeoHookean{soft}});
    const int dim = mesh.dim;
    const auto rotated = [&](const Eigen::VectorXd& u) {
      Eigen::VectorXd result = u;
      for (std::int32_t node = 0; node < mesh.num_local(); ++node) {
        const Eigen::Map<const Eigen::VectorXd> X(mesh.position(node).data(), dim);
        result.segment(node * dim, dim) = R.topLeftCorner(dim, dim) * (X + u.segment(node * dim, dim)) - X;
      }
      return result;
    };
    const Eigen::VectorXd u = 0.1 * random_vector(layout.num_global(), 4), none = Eigen::VectorXd::Zero(u.size());
    CHECK(residual_of(layout, form, rotated(none)).norm() < 1e-12 * soft.young);
    const Eigen::VectorXd before = residual_of(layout, form, u), after = residual_of(layout, form, rotated(u));
    Eigen::VectorXd turned = before;
    for (std::int32_t node = 0; node < mesh.num_local(); ++node)
      turned.segment(node * dim, dim) = R.topLeftCorner(dim, dim) * before.segment(node * dim, dim);
    REQUIRE(before.norm() > 0.01);
    CHECK((turned - after).norm() < 1e-12 * before.norm());
    CHECK(form.stored_energy(state_of(rotated(u))) == doctest::Approx(form.stored_energy(state_of(u))).epsilon(1e-12));
  }
}

TEST_CASE("finite: at rest the tangent is the stiffness of small strain, mean dilatation included") {
  for (const auto& [type, space] : finite_cases()) {
    if (type == ElementType::Triangle6 || type == ElementType::Tetrahedron10) continue; // there it has a bubble
    CAPTURE(int(type));
    CAPTURE(int(space));
    const Elastic rubber{7.0, 0.4999};
    const Mesh mesh = small_mesh(type, {1, 1, 1});
    const DofLayout layout(mesh, {}, {});
    BulkForm linear(layout, space, {rubber});
    FiniteBulkForm finite(layout, space, {NeoHookean{rubber}});
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(layout.num_global());
    const Eigen::MatrixXd K = tangent_of(layout, linear, none);
    CHECK((tangent_of(layout, finite, none) - K).norm() < 1e-12 * K.norm());
  }
}

TEST_CASE("finite: only an accepted increment is remembered, and history goes back") {
  const Mesh mesh = small_mesh(ElementType::Quadrilateral4);
  const DofLayout layout(mesh, {}, {});
  FiniteBulkForm form(layout, Space::PlaneStrain, {FinitePlastic{metal()}});
  const Eigen::VectorXd u = nodal_values(mesh, [](auto X) { return std::array<double, 3>{0.05 * X[0], 0, 0}; });
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(u.size());
  const auto virgin = form.history();
  const Eigen::VectorXd loaded = residual_of(layout, form, u, 1.0);
  CHECK(form.dissipated_energy(state_of(u, 1.0)) > 0.0);
  CHECK(residual_of(layout, form, none, 1.0).norm() < 1e-14); // tried, not accepted: nothing stays
  form.commit(state_of(u, 1.0));
  const double heat = form.dissipated_energy(state_of(u, 1.0));
  CHECK(heat > 0.0);
  CHECK((residual_of(layout, form, u, 1.0) - loaded).norm() < 1e-11 * loaded.norm());
  CHECK(residual_of(layout, form, none, 2.0).norm() > 0.01 * loaded.norm());
  form.restore(virgin);
  CHECK(residual_of(layout, form, none, 1.0).norm() < 1e-14);
  CHECK(form.dissipated_energy(state_of(none, 1.0)) == 0.0);
}

TEST_CASE("finite: a cell turned inside out is a reason given, on that rank, and never a number") {
  for (const auto& [type, space] : finite_cases()) {
    CAPTURE(int(type));
    const Mesh mesh = small_mesh(type, {1, 1, 1});
    const DofLayout layout(mesh, {}, {});
    FiniteBulkForm form(layout, space, {NeoHookean{soft}});
    const Eigen::VectorXd u = nodal_values(mesh, [](auto X) { return std::array<double, 3>{0, -1.5 * X[1], 0}; });
    const VecHandle global = layout.new_vector();
    Residual residual(layout, global);
    form.add_residual(state_of(u), residual);
    CHECK(residual.failure() == "in body 'block' det F is not positive");
    for (const double force : residual.nodal())
      CHECK(std::isfinite(force));
  }
}
