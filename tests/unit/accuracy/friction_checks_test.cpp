// Friction that is right passes; each wrong claim about shear, slip or status is found by the right item, with its
// value in closed form.
#include "blocks.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;
using Names = std::vector<std::string>;

namespace {

/// Of all displacement increments of stretched_block: at the upper corners of the upper block.
const double largest_increment = std::hypot(0.01, 0.02);

void scale(std::vector<std::array<double, 3>>& vectors, double factor) {
  for (auto& vector : vectors)
    for (double& component : vector)
      component *= factor;
}

} // namespace

TEST_CASE("certify: sliding blocks pass with values at rounding") {
  for (const int dim : {2, 3}) {
    const Certificate certificate = stretched_block(MPI_COMM_WORLD, dim).certify();
    CHECK(failures(certificate).empty());
    for (const char* name : {"friction_cone", "slip", "dissipation", "body_balance", "complementarity"})
      CHECK(item(certificate, name).value < 1e-12);
  }
}

TEST_CASE("certify: shear above or below the limit while sliding, or by another law than the pair's") {
  for (const int dim : {2, 3}) {
    Case scene = stretched_block(MPI_COMM_WORLD, dim);
    scale(scene.samples[0].shear, 1.1);
    CHECK(item(scene.certify(), "friction_cone").value == doctest::Approx(0.03 / 0.33).epsilon(1e-10));
    CHECK(item(scene.certify(), "friction_cone").where.find("pair 'interface' at (") != std::string::npos);
    CHECK(failures(scene.certify()) == Names{"friction_cone"});

    scene = stretched_block(MPI_COMM_WORLD, dim);
    scale(scene.samples[0].shear, 0.9);
    CHECK(item(scene.certify(), "friction_cone").value == doctest::Approx(0.1).epsilon(1e-10));

    scene = stretched_block(MPI_COMM_WORLD, dim);
    scene.pairs[0].friction = Coulomb{.mu = 0.2}; // the limits claimed (tau_c) are of no interest
    CHECK(item(scene.certify(), "friction_cone").value == doctest::Approx(0.1 / 0.3).epsilon(1e-10));
    CHECK(failures(scene.certify()) == Names{"friction_cone"});
  }
}

TEST_CASE("certify: shear on an open point, and shear that leaves the tangent plane") {
  Case scene = stretched_block(MPI_COMM_WORLD, 2);
  for (std::size_t i = 0; i < scene.samples[0].size(); ++i)
    scene.samples[0].status[i] = ContactStatus::Open;
  CHECK(item(scene.certify(), "friction_cone").value == doctest::Approx(1.0));

  scene = stretched_block(MPI_COMM_WORLD, 2);
  for (auto& shear : scene.samples[0].shear)
    shear[1] = shear[0] > 0.0 ? 0.03 : -0.03; // a couple, no force
  CHECK(item(scene.certify(), "friction_cone").value == doctest::Approx(0.03 / std::hypot(0.3, 0.03)).epsilon(1e-10));
  CHECK(failures(scene.certify()) == Names{"body_balance", "friction_cone"});
}

TEST_CASE("certify: what is said to stick has moved, what is said to slide has not") {
  for (const int dim : {2, 3}) {
    Case scene = stretched_block(MPI_COMM_WORLD, dim);
    scale(scene.samples[0].slip, 0.0);
    for (auto& status : scene.samples[0].status)
      status = ContactStatus::Stick;
    // The mean of |0.02 (x − 1/2)| is 0.005.
    CHECK(item(scene.certify(), "slip").value == doctest::Approx(0.005 / largest_increment).epsilon(1e-10));
    CHECK(failures(scene.certify()) == Names{"slip"});

    scene = stretched_block(MPI_COMM_WORLD, dim);
    scale(scene.samples[0].slip, 3.0);
    CHECK(item(scene.certify(), "slip").value == doctest::Approx(0.01 / largest_increment).epsilon(1e-10));
    CHECK(failures(scene.certify()) == Names{"slip"});
  }
}

TEST_CASE("certify: friction that drives the motion") {
  for (const int dim : {2, 3}) {
    Case scene = stretched_block(MPI_COMM_WORLD, dim);
    scale(scene.samples[0].shear, -1.0);
    CHECK(item(scene.certify(), "dissipation").value == doctest::Approx(1.0));
    CHECK(failures(scene.certify()) == Names{"dissipation"});
  }
}

TEST_CASE("certify: a rigid master that moves under a block at rest") {
  Case scene;
  scene.mesh = block_mesh(MPI_COMM_WORLD, 2, {{"block", {0, 0, 0}, {1, 1, 0}, {4, 4, 1}}});
  scene.space = Space::PlaneStress;
  displace(scene, [](const auto&) { return std::array<double, 3>{}; });
  load(scene, "block_top", {0.3, -1.0, 0.0});
  MovedShape plane{RigidPlane{{0, 0, 0}, {0, 1, 0}}, {0.1, 0.0, 0.0}, {0.1, 0.0, 0.0}};
  scene.pairs = {{"floor", "block_bottom", plane, Coulomb{.mu = 0.3}}};
  scene.samples = {uniform_samples(scene.mesh, "block_bottom", 1.0, {0, 1, 0})};
  ContactSamples& samples = scene.samples[0];
  samples.has_friction = true;
  const std::size_t n = samples.size();
  samples.shear.assign(n, {0.3, 0.0, 0.0});
  samples.slip.assign(n, {-0.1, 0.0, 0.0});
  samples.accumulated_slip.assign(n, 0.1);
  samples.tau_c.assign(n, 0.3);
  samples.friction_context.assign(n, {.dt = 1.0, .factor = 1.0, .new_contact = true});
  samples.friction_state_old.assign(n, {});
  for (const char* name : {"friction_cone", "slip", "dissipation"})
    CHECK(item(scene.certify(), name).value < 1e-12);
  plane.increment = {}; // it has been there for long
  scene.pairs[0].master = plane;
  CHECK_FALSE(item(scene.certify(), "slip").passed);
}

TEST_CASE("certify: samples with friction of a pair without, and the reverse, are refused") {
  Case scene = stretched_block(MPI_COMM_WORLD, 2);
  scene.pairs[0].friction.reset();
  CHECK_THROWS_AS(scene.certify(), std::invalid_argument);
  scene = compressed_blocks(MPI_COMM_WORLD, 2);
  scene.pairs[0].friction = Coulomb{.mu = 0.3};
  CHECK_THROWS_AS(scene.certify(), std::invalid_argument);
}
