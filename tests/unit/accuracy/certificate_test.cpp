// The exact solution passes; each way of breaking it is found by the right item, with the value that the break has.
#include "blocks.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <numbers>

using namespace amontons;
using namespace amontons::testing;
using Names = std::vector<std::string>;

namespace {

/// Applies a change to the displacement of the nodes at a place (on all ranks that have one).
void move_nodes(Case& scene, const std::array<double, 3>& place, int body, const std::array<double, 3>& by) {
  const int dim = scene.mesh.dim;
  std::vector<std::uint8_t> of_body(scene.mesh.num_local(), 0);
  for (const auto& block : scene.mesh.blocks)
    if (block.body == body)
      for (const auto node : block.nodes)
        of_body[node] = 1;
  for (std::int32_t node = 0; node < scene.mesh.num_local(); ++node) {
    double distance = 0.0;
    for (int c = 0; c < dim; ++c)
      distance += std::abs(scene.mesh.position(node)[c] - place[c]);
    if (distance > 1e-9 || of_body[node] == 0) continue;
    for (int c = 0; c < dim; ++c)
      scene.displacement[std::size_t(node) * dim + c] += by[c];
  }
}

} // namespace

TEST_CASE("certify: the exact solution passes with values at rounding") {
  for (const int dim : {2, 3}) {
    const Certificate certificate = compressed_blocks(MPI_COMM_WORLD, dim).certify();
    CHECK(certificate.items.size() == 16);
    CHECK(certificate.passed());
    CHECK(failures(certificate).empty());
    for (const auto& one : certificate.items) {
      CAPTURE(one.name);
      CHECK(std::abs(one.value - (one.name == "volume_ratio" ? 0.99 : 0.0)) < 1e-12);
    }
  }
}

TEST_CASE("certify: a slave node pressed into the master is penetration and a missed contact") {
  for (const int dim : {2, 3}) {
    Case scene = compressed_blocks(MPI_COMM_WORLD, dim);
    std::array<double, 3> centre{0.5, 0.5, 0.5}, by{};
    centre[dim - 1] = 1.0;
    by[dim - 1] = -0.05; // the facets of the upper block have size 1/2
    move_nodes(scene, centre, 1, by);
    const Certificate certificate = scene.certify();
    CHECK(item(certificate, "penetration").value == doctest::Approx(0.1).epsilon(1e-10));
    CHECK(item(certificate, "penetration").where.find("pair 'interface'") != std::string::npos);
    CHECK(item(certificate, "missed_contact").value == doctest::Approx(0.1).epsilon(1e-2)); // size now, slightly bent
    CHECK(item(certificate, "missed_contact").where.find("a contact is declared") != std::string::npos);
    CHECK(failures(certificate) == Names{"penetration", "complementarity", "missed_contact"});
  }
}

TEST_CASE("certify: pressure across an open gap violates complementarity") {
  for (const int dim : {2, 3}) {
    Case scene = compressed_blocks(MPI_COMM_WORLD, dim);
    for (std::int32_t node = 0; node < scene.mesh.num_local(); ++node)
      if (scene.mesh.position(node)[dim - 1] > 1.2) scene.displacement[std::size_t(node) * dim + dim - 1] += 0.02;
    for (int i = 0; i <= 2; ++i)
      for (int j = 0; j <= (dim == 3 ? 2 : 0); ++j) {
        std::array<double, 3> place{0.5 * i, 0.5 * j, 1.0}, by{};
        if (dim == 2) place = {0.5 * i, 1.0, 0.0};
        by[dim - 1] = 0.02;
        move_nodes(scene, place, 1, by);
      }
    const Certificate certificate = scene.certify();
    CHECK(item(certificate, "complementarity").value == doctest::Approx(0.02 / 0.5).epsilon(1e-10));
    CHECK(item(certificate, "complementarity").where.find("pair 'interface', largest at (") == 0);
    CHECK(failures(certificate) == Names{"complementarity"});
  }
}

TEST_CASE("certify: a pressure that the forces do not bear out breaks the balance of the bodies") {
  for (const int dim : {2, 3}) {
    Case scene = compressed_blocks(MPI_COMM_WORLD, dim);
    for (double& pressure : scene.samples[0].pressure)
      pressure *= 1.1;
    const Certificate certificate = scene.certify();
    // 0.1 of excess on Σ|f| = 2 at top and bottom plus 1.1 at the interface.
    CHECK(item(certificate, "body_balance").value == doctest::Approx(0.1 / 3.1).epsilon(1e-10));
    CHECK(failures(certificate) == Names{"body_balance"});
  }
}

TEST_CASE("certify: a pressure moved to one side breaks the moments of the bodies only") {
  Case scene = compressed_blocks(MPI_COMM_WORLD, 2);
  auto& samples = scene.samples[0];
  // Weight 1 + (x − 1/2): the same force, a moment of 1/12.
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples.pressure[i] *= 0.5 + samples.place[i][0];
  const Certificate certificate = scene.certify();
  CHECK(item(certificate, "body_balance").value == doctest::Approx(1.0 / 12.0 / std::sqrt(5.0) / 3.0).epsilon(1e-10));
  CHECK(failures(certificate) == Names{"body_balance"});
}

TEST_CASE("certify: a wrong reaction breaks the balance of forces, a couple that of moments") {
  for (const int dim : {2, 3}) {
    Case scene = compressed_blocks(MPI_COMM_WORLD, dim);
    std::array<double, 3> up{};
    up[dim - 1] = 0.01;
    load(scene, "lower_bottom", up);
    CHECK(item(scene.certify(), "force_balance").value == doctest::Approx(0.01 / 3.01).epsilon(1e-10));
    CHECK_FALSE(item(scene.certify(), "force_balance").passed);

    scene = compressed_blocks(MPI_COMM_WORLD, dim);
    load(scene, "upper_top", {0.01, 0.0, 0.0});
    load(scene, "lower_bottom", {-0.01, 0.0, 0.0});
    const Certificate certificate = scene.certify();
    CHECK(item(certificate, "force_balance").passed);
    CHECK_FALSE(item(certificate, "moment_balance").passed);
    CHECK(item(certificate, "moment_balance").value ==
          doctest::Approx(0.02 / (std::sqrt(dim + 3.0) * 3.0)).epsilon(1e-3));
  }
}

TEST_CASE("certify: tension at a point or at a node") {
  for (const bool nodal : {true, false}) {
    Case scene = compressed_blocks(MPI_COMM_WORLD, 2);
    auto& pressures = nodal ? scene.samples[0].nodal_pressure : scene.samples[0].pressure;
    if (!pressures.empty()) pressures[0] = -0.25; // one on every rank that has slave facets
    const Certificate certificate = scene.certify();
    CHECK(item(certificate, "tension").value == doctest::Approx(0.25));
    CHECK_FALSE(item(certificate, "tension").passed);
    CHECK(item(certificate, "tension").where.find("pair 'interface' at (") != std::string::npos);
  }
}

TEST_CASE("certify: after a release the pressures are rounding, and tension among them is none") {
  Case scene = compressed_blocks(MPI_COMM_WORLD, 2);
  auto& samples = scene.samples[0];
  std::fill(samples.pressure.begin(), samples.pressure.end(), 0.0);
  std::fill(samples.nodal_pressure.begin(), samples.nodal_pressure.end(), -1e-15);
  CHECK_FALSE(item(scene.certify(), "tension").passed);
  scene.force_floor = 1e-11;
  CHECK(item(scene.certify(), "tension").value > 0.0);
  CHECK(item(scene.certify(), "tension").passed);
}

TEST_CASE("certify: energy outside of its bounds and virtual work out of balance") {
  Case scene = compressed_blocks(MPI_COMM_WORLD, 2);
  scene.energy.external_work = 0.011;
  scene.energy.work_uncertainty = 0.0005;
  CHECK(item(scene.certify(), "energy").value == doctest::Approx(0.0005 / 0.011));
  CHECK(failures(scene.certify()) == Names{"energy"});
  scene.energy.work_uncertainty = 0.00101;
  CHECK(scene.certify().passed());
  scene.energy.virtual_work_defect = -0.004;
  CHECK(item(scene.certify(), "virtual_work").value == doctest::Approx(0.1));
  CHECK(failures(scene.certify()) == Names{"virtual_work"});
  scene.energy.virtual_work_defect = std::numeric_limits<double>::quiet_NaN();
  scene.energy.stored = std::numeric_limits<double>::quiet_NaN();
  CHECK(failures(scene.certify()) == Names{"virtual_work", "energy"});
}

TEST_CASE("certify: a support that is not where it is put") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    Case scene = compressed_blocks(MPI_COMM_WORLD, dim); // the largest displacement is 0.02, of the top
    for (std::int32_t node = 0; node < scene.mesh.num_owned; ++node)
      for (int c = 0; c < dim && scene.mesh.position(node)[dim - 1] > 1.99; ++c)
        scene.supports.push_back({node, c, c == dim - 1 ? -0.02 : 0.0});
    CHECK(item(scene.certify(), "supports").value < 1e-15);
    for (auto& support : scene.supports)
      if (support.component == 0 && scene.mesh.position(support.node)[0] > 0.99) support.displacement = 2e-6;
    const Certificate certificate = scene.certify();
    CHECK(item(certificate, "supports").value == doctest::Approx(1e-4).epsilon(1e-9));
    CHECK(item(certificate, "supports").where.find("displacement along x at (1") != std::string::npos);
    CHECK(failures(certificate) == Names{"supports"});
  }
}

TEST_CASE("certify: a cell turned inside out") {
  Case scene = compressed_blocks(MPI_COMM_WORLD, 2);
  move_nodes(scene, {1.0 / 3.0, 1.0 / 3.0, 0.0}, 0, {0.5, 0.0, 0.0});
  const Certificate certificate = scene.certify();
  CHECK(item(certificate, "volume_ratio").value < 0.0);
  CHECK(item(certificate, "volume_ratio").where.find("body 'lower'") != std::string::npos);
  CHECK(failures(certificate) == Names{"volume_ratio"});
}

TEST_CASE("certify: the hoop counts in the axisymmetric volume ratio, and only the axial force in the balance") {
  Case scene;
  scene.mesh = block_mesh(MPI_COMM_WORLD, 2, {{"ring", {1, 0, 0}, {2, 1, 0}, {2, 2, 1}}});
  scene.space = Space::Axisymmetric;
  displace(scene, [](const auto& x) { return std::array{0.1 * x[0], -0.2 * x[1], 0.0}; });
  load(scene, "ring_sides", {1.0, 0.0, 0.0}); // radial: balanced by the hoop stress
  CHECK(scene.certify().passed());
  CHECK(item(scene.certify(), "volume_ratio").value == doctest::Approx(1.1 * 1.1 * 0.8).epsilon(1e-12));
  load(scene, "ring_top", {0.0, 1.0, 0.0});
  CHECK(failures(scene.certify()) == Names{"force_balance", "body_balance"});
}

TEST_CASE("certify: what is not a number passes nothing") {
  Case scene = compressed_blocks(MPI_COMM_WORLD, 2);
  scene.displacement[0] = std::numeric_limits<double>::quiet_NaN();
  const Certificate certificate = scene.certify();
  CHECK(certificate.items.size() == 16);
  CHECK(failures(certificate).size() == 16);
}

TEST_CASE("certify: refuses arrays that do not fit") {
  Case scene = compressed_blocks(MPI_COMM_WORLD, 2);
  scene.samples.clear();
  CHECK_THROWS_AS(scene.certify(), std::invalid_argument);
  scene = compressed_blocks(MPI_COMM_WORLD, 2);
  scene.external.push_back(0.0);
  CHECK_THROWS_AS(scene.certify(), std::invalid_argument);
}

TEST_CASE("certify: forces below the floor are rounding") {
  Case scene = compressed_blocks(MPI_COMM_WORLD, 2);
  displace(scene, [](const auto&) { return std::array<double, 3>{}; });
  scene.samples = {uniform_samples(scene.mesh, "upper_bottom", 0.0, {0, 1, 0})};
  std::fill(scene.external.begin(), scene.external.end(), 0.0);
  load(scene, "lower_bottom", {0.0, 1e-15, 0.0});
  CHECK(failures(scene.certify()) == Names{"force_balance", "body_balance"});
  scene.force_floor = 1e-8;
  CHECK(scene.certify().passed());
}

TEST_CASE("certify: a slave that bends down beyond the end of the master does not penetrate") {
  for (const int dim : {2, 3}) {
    Case scene;
    std::array<double, 3> low{0.25, 0.25, 0.0}, high{0.75, 0.75, 1.0}, upper_low{0, 0, 1}, upper_high{1, 1, 2};
    if (dim == 2) low = {0.25, 0, 0}, high = {0.75, 1, 0}, upper_low = {0, 1, 0}, upper_high = {1, 2, 0};
    scene.mesh =
        block_mesh(MPI_COMM_WORLD, dim, {{"punch", low, high, {3, 3, 3}}, {"slab", upper_low, upper_high, {8, 8, 8}}});
    scene.space = dim == 2 ? Space::PlaneStrain : Space::Solid;
    std::array<double, 3> up{};
    up[dim - 1] = 1.0;
    scene.pairs = {{"contact", "slab_bottom", "punch_top"}};
    // The slab bends down on both sides of the punch, whose nodes have no distance beyond the rim.
    displace(scene, [&](const auto& x) {
      std::array<double, 3> u{};
      for (int c = 0; c + 1 < dim; ++c)
        u[dim - 1] = std::min(u[dim - 1], -0.5 * (std::abs(x[c] - 0.5) - 0.25));
      return u;
    });
    scene.external.assign(scene.displacement.size(), 0.0);
    scene.samples = {uniform_samples(scene.mesh, "slab_bottom", 0.0, up)};
    const Certificate certificate = scene.certify();
    CHECK(item(certificate, "penetration").value < 1e-12);
    CHECK(failures(certificate).empty());
    // Pressure where there is no master is found out.
    for (std::size_t i = 0; i < scene.samples[0].size(); ++i)
      if (std::abs(scene.samples[0].place[i][0] - 0.5) > 0.25) scene.samples[0].pressure[i] = 1.0;
    CHECK_FALSE(item(scene.certify(), "complementarity").passed);
  }
}

TEST_CASE("certify: rigid masters") {
  Case scene;
  scene.mesh = block_mesh(MPI_COMM_WORLD, 2, {{"block", {0, 0, 0}, {1, 1, 0}, {4, 4, 1}}});
  scene.space = Space::PlaneStress;
  displace(scene, [](const auto& x) { return std::array{0.0, 0.02 - 0.01 * x[1], 0.0}; });
  load(scene, "block_top", {0.0, -1.0, 0.0});
  MovedShape plane{RigidPlane{{0, 0, 0}, {0, 1, 0}}, {0.0, 0.02, 0.0}};
  scene.pairs = {{"floor", "block_bottom", plane}};
  scene.samples = {uniform_samples(scene.mesh, "block_bottom", 1.0, {0, 1, 0})};
  CHECK(scene.certify().passed());
  CHECK(item(scene.certify(), "force_balance").value < 1e-12);
  CHECK(item(scene.certify(), "complementarity").value < 1e-12);

  plane.shift[1] = 0.04; // 0.02 into facets of size 1/4
  scene.pairs[0].master = plane;
  CHECK(item(scene.certify(), "penetration").value == doctest::Approx(0.08).epsilon(1e-10));
  CHECK(failures(scene.certify()) == Names{"penetration", "complementarity", "missed_contact"});

  // A ball that is clear of the slave but sticks into the side by 0.05: the facets there are 0.99 / 4 long.
  scene.pairs[0].master = MovedShape{RigidSphere{{1.05, 0.5, 0.0}, 0.1}, {}};
  scene.samples = {uniform_samples(scene.mesh, "block_bottom", 0.0, {0, 1, 0})};
  CHECK(item(scene.certify(), "penetration").value == 0.0);
  CHECK(item(scene.certify(), "missed_contact").value == doctest::Approx(0.05 / 0.2475).epsilon(1e-2));
  CHECK(item(scene.certify(), "missed_contact").where.find("rigid master of pair 'floor'") != std::string::npos);
}

TEST_CASE("certify: points under pressure that have slid off their master, in both kinematics") {
  for (const int dim : {2, 3})
    for (const auto kinematics : {Kinematics::Small, Kinematics::Finite})
      for (const double slide : {0.0, 0.01, 0.3, 5.0}) {
        CAPTURE(dim);
        CAPTURE(slide);
        Case scene = compressed_blocks(MPI_COMM_WORLD, dim);
        scene.kinematics = kinematics;
        std::vector<std::uint8_t> of_upper(scene.mesh.num_local(), 0);
        for (const auto& block : scene.mesh.blocks)
          if (block.body == 1)
            for (const auto node : block.nodes)
              of_upper[node] = 1;
        for (std::int32_t node = 0; node < scene.mesh.num_local(); ++node)
          if (of_upper[node]) scene.displacement[std::size_t(node) * dim] += slide;
        // Facets of the slave are 1/2 long, the master ends at x = 1.
        double sums[2] = {};
        const auto& samples = scene.samples[0];
        for (std::size_t i = 0; i < samples.size(); ++i) {
          const double beside = std::clamp((samples.place[i][0] + slide - 1.0) / 0.5, 0.0, 1.0);
          sums[0] += samples.weight[i] * beside;
          sums[1] += samples.weight[i];
        }
        MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
        const Certificate certificate = scene.certify();
        const auto& left = item(certificate, "left_master");
        const auto& pressed = item(certificate, "complementarity");
        CHECK(pressed.passed == (kinematics == Kinematics::Small || slide < 0.1));
        CHECK(left.value == doctest::Approx(kinematics == Kinematics::Small ? sums[0] / sums[1] : 0.0).epsilon(1e-9));
        CHECK(left.passed == (kinematics == Kinematics::Finite || slide < 0.1));
        if (left.passed) continue;
        CHECK(left.where.find("pair 'interface': points under pressure have left the master") == 0);
        CHECK(left.where.find("use kinematics: finite") != std::string::npos);
        CHECK(failures(certificate) == Names{"left_master"});
      }
}

TEST_CASE("certify: a rigid plane has no end, under a ball one can slide away") {
  Case scene;
  scene.mesh = block_mesh(MPI_COMM_WORLD, 2, {{"block", {0, 0, 0}, {0.1, 0.1, 0}, {2, 2, 1}}});
  scene.space = Space::PlaneStress;
  scene.external.assign(scene.mesh.coordinates.size(), 0.0);
  const double slide = 0.5, radius = 1.0;
  displace(scene, [&](const auto&) { return std::array{slide, 0.0, 0.0}; });
  scene.samples = {uniform_samples(scene.mesh, "block_bottom", 1.0, {0, 1, 0})};
  scene.pairs = {{"floor", "block_bottom", MovedShape{RigidPlane{{0, 0, 0}, {0, 1, 0}}, {}}}};
  CHECK(item(scene.certify(), "left_master").value < 1e-15);

  scene.pairs[0].master = MovedShape{RigidSphere{{0.05, -radius, 0.0}, radius}, {}};
  // The nearest place of the disc, along the bottom of the block.
  const auto beside = [&](double x) {
    return std::min(1.0, std::abs(x - 0.05) * (1.0 - radius / std::hypot(x - 0.05, radius)) / 0.05);
  };
  double sums[2] = {};
  const auto& samples = scene.samples[0];
  for (std::size_t i = 0; i < samples.size(); ++i) {
    sums[0] += samples.weight[i] * (beside(samples.place[i][0] + slide) - beside(samples.place[i][0]));
    sums[1] += samples.weight[i];
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  CHECK(item(scene.certify(), "left_master").value == doctest::Approx(sums[0] / sums[1]).epsilon(1e-9));
  CHECK_FALSE(item(scene.certify(), "left_master").passed);
}
