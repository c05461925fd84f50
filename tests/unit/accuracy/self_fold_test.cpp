// A body folded onto itself: a clean fold passes, one that cuts into itself is found with its depth, declared or not.
#include "blocks.hpp"
#include "fold.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::testing;
using namespace amontons::test;
using Names = std::vector<std::string>;

namespace {

constexpr double length = 4.0, thickness = 0.1, cell = 0.2;

/// A strip in the shape of a fold, without forces.
Case folded(int dim, const Fold& fold) {
  const std::array<double, 3> size = dim == 2 ? std::array{length, thickness, 0.0} : std::array{length, 0.2, thickness};
  Case scene{.mesh = block_mesh(MPI_COMM_WORLD, dim, {{"strip", {}, size, {20, 1, 1}}}),
             .displacement = {},
             .external = {},
             .pairs = {},
             .samples = {},
             .supports = {},
             .energy = {}};
  scene.space = dim == 2 ? Space::PlaneStrain : Space::Solid;
  scene.kinematics = Kinematics::Finite;
  scene.mesh.surfaces["skin"] = scene.mesh.exterior;
  displace(scene, [&](const std::array<double, 3>& X) {
    const auto now = fold(X[0], X[std::size_t(dim) - 1]);
    std::array<double, 3> u{};
    u[0] = now[0] - X[0];
    u[std::size_t(dim) - 1] = now[1] - X[std::size_t(dim) - 1];
    return u;
  });
  scene.external.assign(scene.displacement.size(), 0.0);
  return scene;
}

void declare(Case& scene) {
  scene.pairs = {{.name = "fold", .slave = "skin", .master = std::string("skin")}};
  scene.samples.resize(1);
}

} // namespace

TEST_CASE("certify: a body folded close to itself passes, with the contact declared or not") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    Case scene = folded(dim, hairpin(length, thickness, 0.03));
    CHECK(failures(scene.certify()).empty());
    CHECK(item(scene.certify(), "missed_contact").value == 0.0);
    declare(scene);
    CHECK(failures(scene.certify()).empty());
    CHECK(item(scene.certify(), "penetration").value == 0.0);
  }
}

TEST_CASE("certify: a body folded into itself is found with its depth") {
  const double depth = 0.02;
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    Case scene = folded(dim, hairpin(length, thickness, -depth));
    const auto undeclared = item(scene.certify(), "missed_contact");
    CHECK(undeclared.value == doctest::Approx(depth / cell).epsilon(0.05));
    CHECK(undeclared.where.find("no contact is declared of it with itself") != std::string::npos);
    CHECK(failures(scene.certify()) == Names{"missed_contact"});
    declare(scene);
    const auto certificate = scene.certify();
    CHECK(item(certificate, "penetration").value == doctest::Approx(depth / cell).epsilon(1e-9));
    CHECK(item(certificate, "missed_contact").where.find("a contact is declared of it with itself") !=
          std::string::npos);
    CHECK(failures(certificate) == Names{"penetration", "missed_contact"});
  }
}

TEST_CASE("certify: a wall squeezed to 30 % of its thickness is no fold") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    Case scene = folded(dim, [](double s, double eta) { return Eigen::Vector2d(3.3 * s, 0.3 * eta); });
    declare(scene);
    CHECK(failures(scene.certify()).empty());
  }
}
