// What remedies do to a contact pair: held points, held friction bounds, another augmentation; and that nothing is left
// of it once it has been let go.
#include "contact/contact_form.hpp"
#include "form/problem.hpp"
#include "two_blocks.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

constexpr double gap0 = 0.01, mu = 0.3;

/// Two blocks with a frictional penalty pair between them, and the upper one moved.
struct Pair {
  Mesh mesh = two_blocks_mesh(PETSC_COMM_WORLD, 2, 3, 4, gap0);
  DofLayout layout{mesh, {}, {}};
  ContactForm* form = nullptr;
  std::unique_ptr<Problem> problem;

  Pair() {
    ContactPair pair{.name = "interface",
                     .slave = "upper_bottom",
                     .master = std::string("lower_top"),
                     .enforcement = Penalty{},
                     .projection = {},
                     .space = Space::PlaneStrain,
                     .stiffness = {100.0, 100.0}};
    pair.alpha = 3.0;
    pair.search_distance = 0.5;
    pair.friction = Friction{.law = Coulomb{.mu = mu}, .factor = {}, .field = -1};
    auto contact = std::make_unique<ContactForm>(layout, std::move(pair));
    form = contact.get();
    std::vector<std::unique_ptr<Form>> forms;
    forms.push_back(std::move(contact));
    problem = std::make_unique<Problem>(layout, std::move(forms), std::vector<PrescribedDisplacement>{});
  }

  /// The upper block moves by (x, y), and turns so that its right end rises by `tilt`.
  VecHandle moved(double x, double y, double tilt = 0.0) const {
    auto u = layout.new_vector();
    VecArray values(u);
    for (std::int32_t node = 0; node < mesh.num_owned; ++node)
      if (mesh.position(node)[1] > 1.0 + 0.5 * gap0) {
        values[2 * node] = x;
        values[2 * node + 1] = y + tilt * mesh.position(node)[0];
      }
    return u;
  }

  VecHandle residual(Vec u) {
    auto result = layout.new_vector();
    problem->residual(u, result);
    return result;
  }
  /// Total force on the upper block, x and y.
  std::array<double, 2> force(Vec u) {
    const auto result = residual(u);
    std::array<double, 2> sum{};
    VecReader values(result);
    for (std::int32_t node = 0; node < mesh.num_owned; ++node)
      if (mesh.position(node)[1] > 1.0 + 0.5 * gap0)
        for (int c = 0; c < 2; ++c)
          sum[c] -= values[2 * node + c];
    MPI_Allreduce(MPI_IN_PLACE, sum.data(), 2, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    return sum;
  }
  double stiffness_over_h() const { return 3.0 * 100.0 * 4.0; } // alpha E / h, h = 1/4
};

bool same(Vec a, Vec b) {
  PetscBool equal = PETSC_FALSE;
  VecEqual(a, b, &equal);
  return equal == PETSC_TRUE;
}

} // namespace

TEST_CASE("held points: open ones carry nothing, closed ones pull as well as they push; let go, all is as before") {
  Pair pair;
  const auto tilted = pair.moved(0.0, -0.02, 0.02); // closed on the left half, gap 0.02 x − 0.01
  const auto free = pair.residual(tilted);
  const auto branches = pair.form->branches();
  using Hold = Switching::Hold;

  pair.form->hold(std::vector<Hold>(branches.size(), Hold::On));
  // ∫ ε (0.02 x − 0.01) dx = 0 over the unit length: what is held closed is linear.
  CHECK(std::abs(pair.force(tilted)[1]) < 1e-12);
  const auto wanted = pair.form->wanted();
  for (std::size_t i = 0; i < branches.size(); ++i)
    CHECK(bool(wanted[i]) == (branches[i] != 0));

  pair.form->hold(std::vector<Hold>(branches.size(), Hold::Off));
  CHECK(pair.force(tilted)[1] == 0.0);

  pair.form->hold({});
  CHECK(same(pair.residual(tilted), free));
  CHECK(pair.form->branches() == branches);
}

TEST_CASE("held limits: friction stays at the bound it had while the pressure doubles") {
  Pair pair;
  const double depth = 0.004, e = pair.stiffness_over_h();
  const auto pressed = pair.moved(0.5, -gap0 - depth), deeper = pair.moved(0.5, -gap0 - 2.0 * depth);
  CHECK(pair.force(pressed)[1] == doctest::Approx(e * depth));
  CHECK(pair.force(pressed)[0] == doctest::Approx(-mu * e * depth)); // slides to the right
  pair.form->hold_limits();
  CHECK(pair.force(deeper)[1] == doctest::Approx(2.0 * e * depth));
  CHECK(pair.force(deeper)[0] == doctest::Approx(-mu * e * depth));
  pair.form->release_limits();
  CHECK(pair.force(deeper)[0] == doctest::Approx(-mu * 2.0 * e * depth));
}

TEST_CASE("another augmentation scales a penalty's force, and the old one comes back bit by bit") {
  Pair pair;
  const double depth = 0.004;
  const auto pressed = pair.moved(0.0, -gap0 - depth);
  const auto before = pair.residual(pressed);
  const double force = pair.force(pressed)[1];
  pair.form->scale_augmentation(0.01);
  CHECK(pair.force(pressed)[1] == doctest::Approx(0.01 * force));
  pair.form->scale_augmentation(1.0);
  CHECK(same(pair.residual(pressed), before));
}
