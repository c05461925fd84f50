// Artificial viscosity against its definition.
#include "form/viscous.hpp"

#include "two_blocks.hpp"

#include <cmath>
#include <doctest/doctest.h>
#include <numeric>

using namespace amontons;
using namespace amontons::test;

namespace {

/// Displacement of all local nodes: the upper block (above 1.2) moves by `upper`, the lower one by `lower`.
std::vector<double> moved(const Mesh& mesh, double lower, double upper) {
  std::vector<double> u(std::size_t(mesh.num_local()) * mesh.dim, 0.0);
  for (std::int32_t node = 0; node < mesh.num_local(); ++node)
    u[std::size_t(node) * mesh.dim] = mesh.position(node)[mesh.dim - 1] > 1.2 ? upper : lower;
  return u;
}

/// Sums of the forces over all ranks, component by component.
std::array<double, 3> total(const Mesh& mesh, const std::vector<double>& forces) {
  std::array<double, 3> sum{};
  for (std::size_t i = 0; i < forces.size(); ++i)
    sum[i % mesh.dim] += forces[i];
  MPI_Allreduce(MPI_IN_PLACE, sum.data(), 3, MPI_DOUBLE, MPI_SUM, mesh.comm);
  return sum;
}

/// Adds up all that is added to it on this rank.
class SumOfTangent : public Tangent {
 public:
  void add(std::span<const PetscInt>, std::span<const double> block) override {
    sum += std::accumulate(block.begin(), block.end(), 0.0);
  }
  double sum = 0.0;
};

} // namespace

TEST_CASE("viscous: bodies that move steadily meet ratio E V d / L^2 over the duration, whatever the increment") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, dim, 2, 3, 0.5);
    const DofLayout layout(mesh, {}, {});
    const double E_lower = 100.0, E_upper = 7.0, ratio = 1e-2, duration = 4.0;
    std::vector<double> stiffness;
    for (const auto& body : mesh.bodies)
      stiffness.push_back(body == "lower" ? E_lower : E_upper);
    ViscousForm form(layout, dim == 2 ? Space::PlaneStrain : Space::Solid, stiffness, ratio, duration);
    const double velocity_lower = 0.3, velocity_upper = -0.8, volume = 1.0, size_squared = dim;
    double time = 0.0;
    for (const double dt : {1.0, 0.125, 2.0}) {
      time += dt;
      const auto u = moved(mesh, velocity_lower * time, velocity_upper * time);
      const State state{.time = time, .unknowns = nullptr, .displacement = u};
      const auto forces = form.nodal_forces(state);
      const double expected = -ratio * duration * volume / size_squared *
                              (E_lower * velocity_lower + E_upper * velocity_upper); // d = velocity x duration
      const auto sum = total(mesh, forces);
      CHECK(sum[0] == doctest::Approx(expected).epsilon(1e-12));
      CHECK(std::abs(sum[1]) < 1e-14);
      // The residual is linear: the tangent times a unit motion of all nodes along x is its resistance.
      CHECK(form.tangent_changed(state));
      SumOfTangent tangent;
      form.add_tangent(state, tangent);
      MPI_Allreduce(MPI_IN_PLACE, &tangent.sum, 1, MPI_DOUBLE, MPI_SUM, mesh.comm);
      const double resistance = ratio * duration / dt * volume / size_squared * (E_lower + E_upper);
      CHECK(tangent.sum == doctest::Approx(dim * resistance).epsilon(1e-12));
      CHECK_FALSE(form.tangent_changed(state));
      form.commit(state);
      CHECK(total(mesh, form.nodal_forces(state))[0] == 0.0); // no time has passed
    }
  }
}

TEST_CASE("viscous: axisymmetric volumes are those of full turns") {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 2, 4, 4, 0.5);
  const DofLayout layout(mesh, {}, {});
  ViscousForm form(layout, Space::Axisymmetric, {1.0, 1.0}, 1.0, 1.0);
  const auto u = moved(mesh, 1.0, 0.0);
  const double pi = std::acos(-1.0);
  // The cylinder 0 < r < 1, 0 < z < 1; L² = 2.
  const auto sum = total(mesh, form.nodal_forces({.time = 1.0, .unknowns = nullptr, .displacement = u}));
  CHECK(sum[0] == doctest::Approx(-pi / 2.0).epsilon(1e-12));
}

TEST_CASE("viscous: history goes back to a copy, and a repeated increment meets the same forces") {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 2, 2, 2, 0.5);
  const DofLayout layout(mesh, {}, {});
  ViscousForm form(layout, Space::PlaneStrain, {1.0, 1.0}, 1.0, 1.0);
  const auto first = moved(mesh, 0.5, 1.0), second = moved(mesh, 0.75, 3.0);
  form.commit({.time = 1.0, .unknowns = nullptr, .displacement = first});
  const State end{.time = 1.5, .unknowns = nullptr, .displacement = second};
  const auto kept = form.history();
  const auto before = form.nodal_forces(end);
  form.commit(end);
  form.restore(kept);
  CHECK(form.nodal_forces(end) == before);
}
