// A solution broken on purpose, in small and finite kinematics (the scene turned by a large angle) and in contact that
// is not paired by hand: a node moved, a multiplier scaled, a facet dropped, a normal flipped. Each is found by the
// item that is meant for it.
#include "blocks.hpp"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <numbers>

using namespace amontons;
using namespace amontons::testing;
using Names = std::vector<std::string>;

namespace {

enum class Setting { Small, Finite, Unpaired };

/// Rotation in the plane of the first and the vertical axis.
std::array<double, 3> turned(std::array<double, 3> v, int dim, double angle) {
  const double x = v[0], z = v[dim - 1];
  v[0] = std::cos(angle) * x - std::sin(angle) * z;
  v[dim - 1] = std::sin(angle) * x + std::cos(angle) * z;
  return v;
}

struct Scene {
  Case solved;
  int dim;
  double angle = 0.0;

  Scene(int dimension, Setting setting) : solved(compressed_blocks(MPI_COMM_WORLD, dimension)), dim(dimension) {
    if (setting == Setting::Small) return;
    solved.kinematics = Kinematics::Finite;
    if (setting == Setting::Unpaired) unpair();
    angle = 50.0 * std::numbers::pi / 180.0;
    for (std::int32_t node = 0; node < solved.mesh.num_local(); ++node) {
      std::array<double, 3> now{}, force{};
      for (int c = 0; c < dim; ++c) {
        now[c] = solved.mesh.position(node)[c] + solved.displacement[std::size_t(node) * dim + c];
        force[c] = solved.external[std::size_t(node) * dim + c];
      }
      now = turned(now, dim, angle);
      force = turned(force, dim, angle);
      for (int c = 0; c < dim; ++c) {
        solved.displacement[std::size_t(node) * dim + c] = now[c] - solved.mesh.position(node)[c];
        solved.external[std::size_t(node) * dim + c] = force[c];
      }
    }
    for (auto& normal : solved.samples[0].normal)
      normal = turned(normal, dim, angle);
  }

  /// The whole exterior with itself; the upper block's bottom carries the pressure.
  void unpair() {
    solved.mesh.surfaces["skin"] = solved.mesh.exterior;
    solved.pairs = {{.name = "interface", .slave = "skin", .master = std::string("skin")}};
    std::array<double, 3> up{};
    up[dim - 1] = 1.0;
    auto samples = uniform_samples(solved.mesh, "skin", 0.0, up);
    const auto& skin = solved.mesh.surfaces.at("skin");
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (skin.bodies[samples.facet[i]] == 1 && std::abs(samples.place[i][dim - 1] - 1.0) < 1e-9) {
        samples.pressure[i] = 1.0;
        samples.status[i] = ContactStatus::Slip;
      }
    solved.samples = {samples};
  }

  /// Calls `change` for each sample of the slave facet at the corner x < 1/2 (and y < 1/2).
  template <class Change>
  void at_one_facet(Change&& change) {
    auto& samples = solved.samples[0];
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (samples.pressure[i] > 0.0 && samples.place[i][0] < 0.5 && (dim == 2 || samples.place[i][1] < 0.5))
        change(samples, i);
  }
};

template <class Test>
void in_all_settings(Test&& test) {
  for (const int dim : {2, 3})
    for (const auto setting : {Setting::Small, Setting::Finite, Setting::Unpaired}) {
      CAPTURE(dim);
      CAPTURE(static_cast<int>(setting));
      test(Scene(dim, setting), setting);
    }
}

bool contains(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

} // namespace

TEST_CASE("breakage: the solution itself passes in all settings") {
  in_all_settings([](const Scene& scene, Setting) {
    const auto certificate = scene.solved.certify();
    CHECK(failures(certificate) == Names{});
    CHECK(item(certificate, "penetration").value < 1e-12);
    CHECK(item(certificate, "body_balance").value < 1e-12);
  });
}

TEST_CASE("breakage: a slave node moved into the master") {
  in_all_settings([](Scene scene, Setting setting) {
    auto& mesh = scene.solved.mesh;
    std::array<double, 3> by{};
    by[scene.dim - 1] = -0.05; // facets of the upper block have size 1/2
    by = turned(by, scene.dim, scene.angle);
    for (const auto& block : mesh.blocks) {
      std::vector<std::int32_t> nodes(block.nodes.begin(), block.nodes.end());
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
      for (const auto node : nodes) {
        const auto x = mesh.position(node);
        const bool is_middle = std::abs(x[0] - 0.5) < 1e-9 && (scene.dim == 2 || std::abs(x[1] - 0.5) < 1e-9);
        if (block.body != 1 || !is_middle || std::abs(x[scene.dim - 1] - 1.0) > 1e-9) continue;
        for (int c = 0; c < scene.dim; ++c)
          scene.solved.displacement[std::size_t(node) * scene.dim + c] += by[c];
      }
    }
    const auto certificate = scene.solved.certify();
    // Unpaired, facets of the lower block of size 1/3 look up at the same node from points beside it.
    CHECK(item(certificate, "penetration").value > 0.099);
    CHECK(item(certificate, "penetration").value < (setting == Setting::Unpaired ? 0.15 : 0.101));
    CHECK(contains(failures(certificate), "penetration"));
    CHECK(contains(failures(certificate), "missed_contact"));
  });
}

TEST_CASE("breakage: a multiplier scaled by 1.1") {
  in_all_settings([](Scene scene, Setting) {
    for (double& pressure : scene.solved.samples[0].pressure)
      pressure *= 1.1;
    const auto certificate = scene.solved.certify();
    // 0.1 of excess on Σ|f| = 2 at top and bottom plus 1.1 at the interface.
    CHECK(item(certificate, "body_balance").value == doctest::Approx(0.1 / 3.1).epsilon(1e-10));
    CHECK(failures(certificate) == Names{"body_balance"});
  });
}

TEST_CASE("breakage: a facet dropped") {
  in_all_settings([](Scene scene, Setting) {
    scene.at_one_facet([](ContactSamples& samples, std::size_t i) { samples.pressure[i] = 0.0; });
    const double lost = scene.dim == 2 ? 0.5 : 0.25;
    const auto certificate = scene.solved.certify();
    CHECK(item(certificate, "body_balance").value >= lost / (3.0 - lost) * (1.0 - 1e-10));
    CHECK(failures(certificate) == Names{"body_balance"});
  });
}

TEST_CASE("breakage: a normal flipped") {
  in_all_settings([](Scene scene, Setting) {
    scene.at_one_facet([](ContactSamples& samples, std::size_t i) {
      for (double& component : samples.normal[i])
        component = -component;
    });
    const double reversed = scene.dim == 2 ? 1.0 : 0.5; // what pushed pulls now: twice the force of the facet
    const auto certificate = scene.solved.certify();
    CHECK(item(certificate, "body_balance").value >= reversed / 3.0 * (1.0 - 1e-10));
    CHECK(failures(certificate) == Names{"body_balance"});
  });
}
