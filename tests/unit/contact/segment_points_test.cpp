// Contact points on segments: places, masters and weights against geometry, forces of a uniform pressure on both sides
// against exact ones, independence of the number of ranks, slaves that stick out of the master.
#include "contact/contact_form.hpp"
#include "contact/uzawa_multipliers.hpp"
#include "form/problem.hpp"
#include "two_blocks.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <map>

using namespace amontons;
using namespace amontons::test;

namespace {

constexpr int n_lower = 3, n_upper = 4;

/// The two blocks, the upper one moved sideways by `shift`, all turned about a skew axis.
Mesh make_mesh(MPI_Comm comm, int dim, double gap, double shift = 0.0, double angle = 0.0) {
  auto raw = two_blocks(comm, dim, n_lower, n_upper, gap);
  const Eigen::Vector3d axis = dim == 2 ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(1, 2, 0.5).normalized();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  const std::size_t lower = raw.coordinates.empty() ? 0 : 3 * std::size_t(std::pow(n_lower + 1, dim));
  for (std::size_t i = 0; i + 2 < raw.coordinates.size(); i += 3) {
    Eigen::Map<Eigen::Vector3d> x(&raw.coordinates[i]);
    if (i >= lower) x[0] += shift;
    x = (turn * x).eval();
  }
  return distribute_mesh(comm, raw, {{"upper_bottom", "lower_top"}}, 0);
}

ContactPair declare_pair(const Mesh& mesh, Enforcement enforcement, bool upper_is_slave = true) {
  ContactPair pair{.name = "interface",
                   .slave = upper_is_slave ? "upper_bottom" : "lower_top",
                   .master = std::string(upper_is_slave ? "lower_top" : "upper_bottom"),
                   .enforcement = enforcement,
                   .projection = {},
                   .integration = SegmentIntegration{.degree = 2},
                   .space = mesh.dim == 2 ? Space::PlaneStrain : Space::Solid,
                   .stiffness = {100.0, 300.0}};
  pair.search_distance = 0.3;
  return pair;
}

/// Points of one slave facet: place and weight, in order.
using FacetRecord = std::vector<std::array<double, 4>>;

/// By the facet's centre, rounded.
std::map<std::array<long, 3>, FacetRecord> record(const Mesh& mesh, const ContactPoints& points) {
  std::map<std::array<long, 3>, FacetRecord> records;
  for (const auto& point : points.points()) {
    std::array<double, 3> sum{};
    for (const auto node : points.slave().facet(point.facet))
      for (int c = 0; c < mesh.dim; ++c)
        sum[c] += mesh.position(node)[c];
    std::array<long, 3> key{};
    for (int c = 0; c < 3; ++c)
      key[c] = std::lround(1e6 * sum[c]);
    records[key].push_back({point.place[0], point.place[1], point.place[2], point.weight});
  }
  return records;
}

} // namespace

TEST_CASE("segment points: whole area, right master place, straight across") {
  for (const int dim : {2, 3})
    for (const ProjectionKind& projection : {ProjectionKind(ClosestPoint{}), ProjectionKind(SlaveNormal{})}) {
      CAPTURE(dim);
      CAPTURE(projection.index());
      const auto mesh = make_mesh(PETSC_COMM_WORLD, dim, 0.01, 0.0, 0.8);
      const DofLayout layout(mesh, {}, {});
      auto pair = declare_pair(mesh, Penalty{});
      pair.projection = projection;
      const ContactPoints points(layout, pair);
      double area = 0.0;
      for (const auto& point : points.points()) {
        REQUIRE(point.master >= 0);
        CHECK(point.gap0 == doctest::Approx(0.01).epsilon(1e-11));
        area += point.weight;
        const auto nodes = points.slave().facet(point.facet);
        const auto master = points.master()->positions(point.master);
        const auto shape = points.slave_shape(point);
        for (int c = 0; c < dim; ++c) {
          double on_slave = 0.0, on_master = 0.0;
          for (std::size_t a = 0; a < nodes.size(); ++a)
            on_slave += shape[a] * mesh.position(nodes[a])[c];
          for (std::size_t b = 0; b < master.size() / dim; ++b)
            on_master += point.master_shape[b] * master[b * dim + c];
          CHECK(std::abs(on_slave - point.place[c]) < 1e-14);
          CHECK(std::abs(on_slave - point.gap0 * point.normal[c] - on_master) < 1e-13);
        }
      }
      MPI_Allreduce(MPI_IN_PLACE, &area, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
      CHECK(area == doctest::Approx(1.0).epsilon(1e-13));
    }
}

TEST_CASE("a facet's segment points and their order are the same on any number of ranks") {
  for (const int dim : {2, 3}) {
    const auto everywhere = make_mesh(PETSC_COMM_WORLD, dim, 0.01), alone = make_mesh(PETSC_COMM_SELF, dim, 0.01);
    const DofLayout layout(everywhere, {}, {}), layout_alone(alone, {}, {});
    const auto pair = declare_pair(everywhere, Penalty{});
    const ContactPoints points(layout, pair), points_alone(layout_alone, pair);
    const auto mine = record(everywhere, points), all = record(alone, points_alone);
    CHECK(all.size() == std::size_t(std::pow(n_upper, dim - 1)));
    for (const auto& [centre, facet] : mine) {
      REQUIRE(all.count(centre) == 1);
      CHECK(facet == all.at(centre));
    }
  }
}

TEST_CASE("a uniform pressure on segments gives exact nodal forces on both sides, whichever is slave") {
  for (const int dim : {2, 3})
    for (const bool upper_is_slave : {true, false}) {
      CAPTURE(dim);
      CAPTURE(upper_is_slave);
      const auto mesh = make_mesh(PETSC_COMM_WORLD, dim, 0.0);
      const DofLayout layout(mesh, {}, {});
      std::vector<std::unique_ptr<Form>> forms;
      auto form = std::make_unique<ContactForm>(layout, declare_pair(mesh, Uzawa{}, upper_is_slave));
      form->hold_multipliers(std::vector<double>(form->nodes().nodes.size(), -1.0));
      forms.push_back(std::move(form));
      Problem problem(layout, std::move(forms), {});
      const auto u = layout.new_vector(), residual = layout.new_vector();
      problem.residual(u, residual);
      VecReader force(residual);
      double pushed = 0.0;
      for (std::int32_t node = 0; node < mesh.num_owned; ++node) {
        const double value = force[node * dim + dim - 1];
        pushed += std::abs(value);
        if (value == 0.0) continue;
        // Residual is internal force: that of the lower block pushes up. Half the share on an edge, a quarter in a
        // corner.
        const bool upper = value < 0.0;
        double share = upper ? -1.0 : 1.0;
        for (int c = 0; c < dim - 1; ++c) {
          const double x = mesh.position(node)[c];
          share *= (x < 1e-9 || x > 1.0 - 1e-9 ? 0.5 : 1.0) / (upper ? n_upper : n_lower);
        }
        CHECK(value == doctest::Approx(share).epsilon(1e-12));
      }
      MPI_Allreduce(MPI_IN_PLACE, &pushed, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
      CHECK(pushed == doctest::Approx(2.0).epsilon(1e-12));
    }
}

TEST_CASE("a slave that sticks out of the master: what is over it is covered exactly, the rest is open for good") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    const auto mesh = make_mesh(PETSC_COMM_WORLD, dim, 0.01, 0.4);
    const DofLayout layout(mesh, {}, {});
    const ContactPoints points(layout, declare_pair(mesh, Penalty{}));
    double areas[2] = {}; // covered, all
    for (const auto& point : points.points()) {
      areas[1] += point.weight;
      if (point.master != ContactPoint::none) areas[0] += point.weight;
      CHECK((point.master == ContactPoint::none) == (point.place[0] > 1.0));
    }
    MPI_Allreduce(MPI_IN_PLACE, areas, 2, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    CHECK(areas[0] == doctest::Approx(0.6).epsilon(1e-12));
    CHECK(areas[1] == doctest::Approx(1.0).epsilon(1e-12));
  }
}

TEST_CASE("a slave that sticks out: uniform traction is one multiplier wherever there is a master, zero elsewhere") {
  for (const int dim : {2, 3})
    for (const Integration& integration : {Integration(SegmentIntegration{2}), Integration(FacetIntegration{4})}) {
      CAPTURE(dim);
      CAPTURE(integration.index());
      const double gap = -0.01;
      const auto mesh = make_mesh(PETSC_COMM_WORLD, dim, gap, 0.4); // slave nodes at x = 0.4 ... 1.15, 1.4
      const DofLayout layout(mesh, {}, {});
      auto pair = declare_pair(mesh, Uzawa{});
      pair.integration = integration;
      ContactForm form(layout, pair);
      UzawaMultipliers multipliers(mesh, {&form});
      const auto u = layout.new_vector(), lambda = multipliers.new_vector();
      const std::vector<double> displacement(std::size_t(mesh.num_local()) * dim, 0.0);
      const State state{.time = 0.0, .unknowns = u, .displacement = displacement};
      multipliers.updated(state, lambda);
      multipliers.set(lambda);
      const double epsilon = 150.0 / 0.25; // harmonic mean of the stiffnesses over the facet's size
      for (std::size_t i = 0; i < form.nodes().nodes.size(); ++i) {
        const bool bare = mesh.position(form.nodes().nodes[i])[0] > 1.3;
        CHECK(form.multipliers()[i] == doctest::Approx(bare ? 0.0 : epsilon * gap).epsilon(1e-11));
      }
    }
}

TEST_CASE("a slave that sticks out: no multiplier's equation is empty, and forces are those of the covered part") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    const auto mesh = make_mesh(PETSC_COMM_WORLD, dim, 0.0, 0.4);
    const std::vector<NodeField> fields = {multiplier_nodes(mesh, "interface", "upper_bottom")};
    const DofLayout layout(mesh, {}, fields);
    std::vector<std::unique_ptr<Form>> forms;
    forms.push_back(std::make_unique<ContactForm>(layout, declare_pair(mesh, Semismooth{0})));
    const double scale = static_cast<ContactForm*>(forms[0].get())->multiplier_scale();
    Problem problem(layout, std::move(forms), {});
    const auto u = layout.new_vector(), residual = layout.new_vector();
    {
      VecArray values(u);
      for (PetscInt i = mesh.num_owned * dim; i < values.size(); ++i)
        values[i] = -1.0 / scale;
    }
    // At contact with the right multipliers, the tangent of their rows is in the off-diagonal blocks: look at an open
    // state for the diagonal, where a row of multipliers holds nothing else.
    auto matrix = problem.new_matrix();
    const auto open = layout.new_vector(), diagonal = layout.new_vector();
    {
      VecArray values(open);
      for (PetscInt i = mesh.num_owned * dim; i < values.size(); ++i)
        values[i] = 1.0 / scale;
    }
    problem.tangent(open, matrix);
    MatGetDiagonal(matrix, diagonal);
    VecReader entries(diagonal);
    for (PetscInt i = mesh.num_owned * dim; i < entries.size(); ++i)
      CHECK(entries[i] < -1e-4 * scale / std::pow(n_upper, dim - 1));

    problem.residual(u, residual);
    VecReader force(residual);
    double sums[4] = {}; // up and down: force and moment
    for (std::int32_t node = 0; node < mesh.num_owned; ++node) {
      const double value = force[node * dim + dim - 1];
      const std::size_t side = value < 0.0 ? 2 : 0;
      sums[side] += std::abs(value);
      sums[side + 1] += std::abs(value) * mesh.position(node)[0];
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    for (const int side : {0, 2}) {
      CHECK(sums[side] == doctest::Approx(0.6).epsilon(1e-12));
      CHECK(sums[side + 1] == doctest::Approx(0.5 * (1.0 - 0.4 * 0.4)).epsilon(1e-12));
    }
  }
}
