// Equation numbers, ties, multipliers and the sums over ranks.
#include "fe/dof_layout.hpp"
#include "two_blocks.hpp"

#include <cmath>
#include <doctest/doctest.h>
#include <set>

using namespace amontons;
using namespace amontons::test;

namespace {

NodeField surface_field(const Mesh& mesh, const std::string& name) { return {name, mesh.node_groups.at(name)}; }

} // namespace

TEST_CASE("every equation belongs to exactly one unknown, on any number of ranks") {
  for (const int dim : {2, 3}) {
    const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, dim, 3, 4, 0.1);
    const std::vector<NodeField> fields = {surface_field(mesh, "upper_bottom"), surface_field(mesh, "top")};
    const DofLayout layout(mesh, {}, fields);
    const auto nodes = [&](int n) { return static_cast<PetscInt>(std::pow(n + 1, dim)); };
    const auto surface = [&](int n) { return static_cast<PetscInt>(std::pow(n + 1, dim - 1)); };
    CHECK(layout.num_global() == dim * (nodes(3) + nodes(4)) + 2 * surface(4));
    CHECK(layout.num_extra() == 2 * surface(4));
    std::set<PetscInt> mine;
    for (std::int32_t node = 0; node < mesh.num_owned; ++node) {
      for (int c = 0; c < dim; ++c)
        CHECK(mine.insert(layout.equation(node, c)).second);
      for (int f = 0; f < 2; ++f)
        if (layout.extra_equation(f, node) >= 0) CHECK(mine.insert(layout.extra_equation(f, node)).second);
    }
    REQUIRE(static_cast<PetscInt>(mine.size()) == layout.num_owned());
    if (!mine.empty()) {
      CHECK(*mine.begin() == layout.first_equation());
      CHECK(*mine.rbegin() == layout.first_equation() + layout.num_owned() - 1);
    }
    for (const PetscInt equation : mine) {
      const auto block = layout.block_of(equation);
      CHECK(layout.block_begin(block) <= equation);
      CHECK(equation < layout.block_begin(block) + layout.block_size(block));
      CHECK(block >= layout.first_block());
      CHECK(block < layout.first_block() + layout.num_owned_blocks());
    }
  }
}

TEST_CASE("ghosts see the owner's displacement and multipliers") {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 2, 5, 4, 0.1);
  const std::vector<NodeField> fields = {surface_field(mesh, "lower_top")};
  const DofLayout layout(mesh, {}, fields);
  const auto u = layout.new_vector();
  {
    VecArray values(u);
    for (std::int32_t node = 0; node < mesh.num_owned; ++node)
      for (int c = 0; c < 2; ++c)
        values[layout.equation(node, c) - layout.first_equation()] = mesh.position(node)[c];
  }
  std::vector<double> local(mesh.coordinates.size());
  layout.gather_displacement(u, local);
  CHECK(local == mesh.coordinates);

  const NodeSpace space(mesh, {surface_field(mesh, "lower_top")});
  std::vector<std::vector<double>> ones = {std::vector<double>(space.fields()[0].nodes.size(), 1.0)};
  const auto counts = space.new_vector();
  space.add(ones, counts);
  space.gather(counts, ones);
  double smallest = 1e300;
  for (const double count : ones[0])
    smallest = std::min(smallest, count);
  MPI_Allreduce(MPI_IN_PLACE, &smallest, 1, MPI_DOUBLE, MPI_MIN, PETSC_COMM_WORLD);
  CHECK(smallest == 1.0);
  PetscInt size = 0;
  VecGetSize(counts, &size);
  CHECK(size == 6);
}

TEST_CASE("a tied group shares one equation; its nodes' forces add up there") {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, 3, 2, 3, 0.1);
  const DofLayout layout(mesh, {{"top", 2}}, {});
  for (const auto node : mesh.node_groups.at("top"))
    CHECK(layout.equation(node, 2) == layout.tied_equation(0));
  PetscInt idle = static_cast<PetscInt>(layout.idle_equations().size());
  MPI_Allreduce(MPI_IN_PLACE, &idle, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD);
  CHECK(idle == 15);

  // A unit force at each node, given by its owner alone.
  std::vector<double> forces(mesh.coordinates.size(), 0.0);
  for (std::int32_t node = 0; node < mesh.num_owned; ++node)
    for (int c = 0; c < 3; ++c)
      forces[std::size_t(node) * 3 + c] = 1.0;
  const auto f = layout.new_vector();
  layout.add_forces(forces, f);
  double sum = 0.0, largest = 0.0;
  VecSum(f, &sum);
  VecMax(f, nullptr, &largest);
  CHECK(sum == doctest::Approx(3.0 * (27 + 64)));
  CHECK(largest == doctest::Approx(16.0));
  for (const PetscInt equation : layout.idle_equations()) {
    double value = 1.0;
    VecGetValues(f, 1, &equation, &value);
    CHECK(value == 0.0);
  }
  std::vector<double> back(mesh.coordinates.size());
  layout.gather_displacement(f, back);
  for (const auto node : mesh.node_groups.at("top"))
    CHECK(back[std::size_t(node) * 3 + 2] == doctest::Approx(16.0));
}
