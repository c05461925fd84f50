// A surface that meets itself: who is a partner on strips bent onto themselves, each contact counted once, tangent,
// balance, the same on any number of ranks.
#include "fold.hpp"
#include "lone_pair.hpp"
#include "strip.hpp"
#include "two_blocks.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Three straight layers, each `gap` above the one before it, joined by sharp bends.
Fold zigzag(double length, double thickness, double gap) {
  const double layer = length / 3.0, step = thickness + gap;
  return [=](double s, double eta) {
    const int which = std::min(2, static_cast<int>(s / layer));
    const double along = s - which * layer, sign = which % 2 == 0 ? 1.0 : -1.0;
    const double x = which % 2 == 0 ? along : layer - along;
    return Vector2d(x, which * step + 0.5 * thickness + sign * (eta - 0.5 * thickness));
  };
}

struct Self {
  Strip strip;
  Enforcement enforcement = Penalty{};
  std::optional<FrictionLaw> law = std::nullopt;
  ProjectionKind projection = ClosestPoint{};
  MPI_Comm comm = PETSC_COMM_WORLD;
};

constexpr double stiffness = 100.0, alpha = 3.0;

struct Fixture : LonePair {
  Self self;

  static Mesh mesh_with_skin(const Self& self) {
    auto mesh = distribute_mesh(self.comm, strip(self.comm, self.strip), {}, 0);
    name_exterior(mesh);
    return mesh;
  }

  static ContactPair declare_pair(const Self& self) {
    ContactPair pair{.name = "skin",
                     .slave = exterior_name,
                     .master = std::string(exterior_name),
                     .enforcement = self.enforcement,
                     .projection = self.projection,
                     .kinematics = Kinematics::Finite,
                     .space = self.strip.dim == 3 ? Space::Solid : Space::PlaneStrain,
                     .stiffness = {stiffness}};
    pair.alpha = alpha;
    pair.search_distance = 0.35;
    if (self.law) pair.friction = Friction{.law = *self.law, .factor = std::nullopt};
    return pair;
  }

  explicit Fixture(const Self& s) : LonePair(mesh_with_skin(s), declare_pair(s)), self(s) {
    if (!std::holds_alternative<Uzawa>(self.enforcement)) return;
    std::vector<double> pressure;
    for (const auto node : form->nodes().nodes)
      pressure.push_back(-2.0 - 0.3 * mesh.position(node)[0]);
    form->hold_multipliers(pressure);
  }

  /// Folds the strip in the plane of its length and thickness, with some roughness.
  void fold(Vec vec, const Fold& fold, double roughness = 0.0, int seed = 1) const {
    VecArray values(vec);
    const int d = mesh.dim, up = d - 1;
    for (std::int32_t node = 0; node < mesh.num_owned; ++node) {
      const auto X = reference(node);
      const Vector2d now = fold(X[0], X[up]);
      Vector3d x = X;
      x[0] = now[0];
      x[up] = now[1];
      for (int c = 0; c < d; ++c)
        values[node * d + c] = x[c] - X[c] + roughness * noise(X, c, seed);
    }
  }
  void begin(const Fold& shape, double roughness = 0.0, int seed = 1) {
    fold(u, shape, roughness, seed);
    problem->begin_increment(1.0, u);
    const auto residual = layout->new_vector();
    problem->residual(u, residual);
  }
};

double sum(double mine, MPI_Comm comm = PETSC_COMM_WORLD) {
  MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_SUM, comm);
  return mine;
}

/// Harmonic mean of the sizes of slave facets, before any motion: the h of a penalty.
double mean_size(const ContactForm& form) {
  double facets = 0.0, inverse = 0.0;
  std::int32_t last = -1;
  for (const auto& point : form.points().points()) {
    if (point.facet == last) continue;
    last = point.facet;
    facets += 1.0;
    inverse += 1.0 / point.size;
  }
  return sum(facets) / sum(inverse);
}

double norm(Vec vec) {
  double value = 0.0;
  VecNorm(vec, NORM_2, &value);
  return value;
}

/// Cells of both dimensions are as long as they are wide.
Strip strip_of(int dim, int order) {
  return {.dim = dim, .order = order, .cells = {order == 1 ? 20 : 10, dim == 2 ? 1 : 2, 1}, .size = {4.0, 0.3, 0.1}};
}

} // namespace

TEST_CASE("self contact: on a hairpin the legs meet, and nobody takes the other side of the wall") {
  for (const int dim : {2, 3})
    for (const int order : {1, 2})
      for (const ProjectionKind& projection : {ProjectionKind(ClosestPoint{}), ProjectionKind(SlaveNormal{})})
        for (const double gap : {0.05, -0.02}) {
          CAPTURE(dim);
          CAPTURE(order);
          CAPTURE(gap);
          CAPTURE(projection.index());
          Fixture fixture({.strip = strip_of(dim, order), .projection = projection});
          fixture.begin(hairpin(4.0, 0.1, gap));
          const auto samples = fixture.form->samples(fixture.problem->state_at(fixture.u));
          double legs = 0.0, backs = 0.0;
          for (std::size_t i = 0; i < samples.size(); ++i) {
            const auto& place = samples.place[i];
            const double s = place[0], eta = place[dim - 1];
            const bool on_leg = s < 1.4 || s > 2.6; // short of the bend
            if (!on_leg || s < 0.05 || s > 3.95) continue;
            const auto& point = fixture.form->points().points()[i];
            if (eta > 0.0999) {
              ++legs;
              CHECK(point.thickness == doctest::Approx(0.1));
              CHECK(point.master >= 0);
              CHECK(samples.gap[i] == doctest::Approx(gap).epsilon(1e-9));
              CHECK((samples.status[i] == ContactStatus::Open) == (gap > 0.0));
            } else if (eta < 1e-4) {
              ++backs;
              CHECK(point.master == ContactPoint::none);
            }
          }
          CHECK(sum(legs) > 15);
          CHECK(sum(backs) > 15);
        }
}

TEST_CASE("self contact: layers beyond the next one are no partners, whichever way they look") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    Fixture fixture({.strip = {.dim = dim, .order = 1, .cells = {30, 2, 1}, .size = {6.0, 0.4, 0.1}}});
    fixture.begin(zigzag(6.0, 0.1, 0.03));
    const auto samples = fixture.form->samples(fixture.problem->state_at(fixture.u));
    double inner = 0.0, outer = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double s = samples.place[i][0], eta = samples.place[i][std::size_t(dim) - 1];
      const double along = std::fmod(s, 2.0);
      if (along < 0.45 || along > 1.55 || (eta > 1e-4 && eta < 0.0999)) continue;
      const int layer = static_cast<int>(s / 2.0);
      const bool top = eta > 0.05, has_next = top ? layer < 2 : layer > 0;
      // The middle layer is turned over: its bottom faces the layer above, its top the one below.
      if (has_next || layer == 1) {
        ++inner;
        CHECK(samples.gap[i] == doctest::Approx(0.03).epsilon(1e-9));
      } else {
        ++outer;
        CHECK(fixture.form->points().points()[i].master == ContactPoint::none);
      }
      CHECK(samples.status[i] == ContactStatus::Open);
    }
    CHECK(sum(inner) > 20);
    CHECK(sum(outer) > 20);
  }
}

TEST_CASE("self contact: a strip squeezed to 30 % or bent to a V does not touch itself") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    Fixture fixture({.strip = strip_of(dim, 1)});
    const Fold squeezed = [](double s, double eta) { return Vector2d(3.3 * s, 0.3 * eta); };
    // The facets on both sides of the fold face each other, but they share a node.
    const Fold folded = [](double s, double eta) {
      const double along = s - 2.0, tilt = 0.5;
      return Vector2d(std::cos(tilt) * std::abs(along) - eta, std::sin(tilt) * along);
    };
    for (const Fold& shape : {squeezed, folded}) {
      fixture.begin(shape);
      CHECK(fixture.form->totals(fixture.problem->state_at(fixture.u)).area == 0.0);
    }
  }
}

TEST_CASE("self contact: each contact counts once, whichever side finds it, and action equals reaction") {
  const double gap = -0.02;
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    Fixture fixture({.strip = strip_of(dim, 1)});
    const double h = mean_size(*fixture.form);
    fixture.begin(hairpin(4.0, 0.1, gap));
    const auto state = fixture.problem->state_at(fixture.u);
    // The legs, both of which carry points; the bend adds some of its own.
    const double width = dim == 3 ? 0.3 : 1.0, least = 1.6 * width;
    const auto totals = fixture.form->totals(state);
    CHECK(totals.area > (1.0 - 1e-9) * least);
    CHECK(totals.area < 1.1 * least);
    CHECK(totals.max_pressure == doctest::Approx(-alpha * stiffness / h * gap).epsilon(1e-9));
    const double energy = sum(fixture.form->stored_energy(state));
    CHECK(energy == doctest::Approx(0.5 * alpha * stiffness / h * gap * gap * totals.area).epsilon(0.05));
    CHECK(std::abs(totals.force[0]) + std::abs(totals.force[dim - 1]) < 0.05 * totals.max_pressure * least);

    const auto residual = fixture.layout->new_vector();
    fixture.problem->residual(fixture.u, residual);
    double sums[5] = {}; // force, moment about the axis of the fold, absolute
    {
      VecReader f(residual), u(fixture.u);
      for (std::int32_t node = 0; node < fixture.mesh.num_owned; ++node) {
        const auto X = fixture.reference(node);
        Vector2d x, force;
        for (const int c : {0, 1}) {
          const int at = c == 0 ? 0 : dim - 1;
          x[c] = X[at] + u[node * dim + at];
          force[c] = f[node * dim + at];
          sums[c] += force[c];
        }
        sums[2] += x[0] * force[1] - x[1] * force[0];
        sums[3] += force.norm();
      }
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 5, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    CHECK(sums[3] > 1.0);
    for (int c = 0; c < 3; ++c)
      CHECK(std::abs(sums[c]) <= 1e-12 * sums[3]);
  }
}

namespace {

/// Status, facet and hold of every point in contact.
std::vector<int> signature(const Fixture& fixture, Vec x) {
  const auto samples = fixture.form->samples(fixture.problem->state_at(x));
  std::vector<int> all;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const bool open = samples.status[i] == ContactStatus::Open;
    all.push_back(int(samples.status[i]));
    all.push_back(open ? 0 : fixture.form->points().points()[i].master);
    all.push_back(open ? 0 : static_cast<int>(fixture.form->points().now(i).hold.index()));
  }
  return all;
}

bool is_smooth(const Fixture& fixture, Vec direction, double range) {
  const auto here = signature(fixture, fixture.u);
  const auto x = fixture.layout->new_vector();
  int same = 1;
  for (const double h : {-1.0, -0.3, 0.3, 1.0}) {
    VecWAXPY(x, h * range, direction, fixture.u);
    same = signature(fixture, x) == here && same;
  }
  MPI_Allreduce(MPI_IN_PLACE, &same, 1, MPI_INT, MPI_MIN, PETSC_COMM_WORLD);
  return same != 0;
}

/// |R(u + h d) − R(u) − h K d| falls by 100 for each decade of h.
void check_taylor(Fixture& fixture, Vec direction, double range) {
  const auto x = fixture.layout->new_vector(), base = fixture.layout->new_vector(),
             remainder = fixture.layout->new_vector(), product = fixture.layout->new_vector();
  auto matrix = fixture.problem->new_matrix();
  fixture.problem->tangent(fixture.u, matrix); // of the first guess
  REQUIRE(fixture.problem->tangent(fixture.u, matrix));
  CHECK(MatMult(matrix, direction, product) == 0);
  fixture.problem->residual(fixture.u, base);
  CHECK(norm(product) > 1e-2);
  CHECK(norm(base) > 1e-3);
  const double rounding = 2e-13 * norm(base);
  std::vector<double> errors;
  for (int k = 0; k < 5; ++k) {
    const double h = range * std::pow(10.0, -0.5 * k);
    VecWAXPY(x, h, direction, fixture.u);
    fixture.problem->residual(x, remainder);
    VecAXPY(remainder, -1.0, base);
    VecAXPY(remainder, -h, product);
    errors.push_back(norm(remainder));
    if (k > 0) CHECK(errors[k] <= 0.115 * errors[k - 1] + rounding); // 0.1 is order 2
  }
  CHECK(errors[0] > 100.0 * rounding); // kinematics is not linear
}

} // namespace

TEST_CASE("self contact: tangent of the whole residual, legs pressed and slid over each other") {
  const std::optional<FrictionLaw> laws[] = {std::nullopt, FrictionLaw(Coulomb{.mu = 0.3})};
  for (const int dim : {2, 3})
    for (const int order : {1, 2})
      for (const Enforcement& enforcement : {Enforcement(Penalty{}), Enforcement(Uzawa{})})
        for (const auto& law : laws) {
          if (dim == 3 && (order == 2 || !law)) continue; // the plane and the pairs of two surfaces have these
          CAPTURE(dim);
          CAPTURE(order);
          CAPTURE(enforcement.index());
          CAPTURE(law.has_value());
          bool found = false;
          for (int seed = 1; seed <= 12 && !found; ++seed) {
            Fixture fixture({.strip = strip_of(dim, order), .enforcement = enforcement, .law = law});
            fixture.begin(hairpin(4.0, 0.1, -0.02), 0.004, seed);
            fixture.problem->commit(fixture.u);
            const Fold pressed = hairpin(4.0, 0.1, -0.022);
            const Fold slid = [&](double s, double eta) {
              return Vector2d(pressed(s, eta) + Vector2d(s > 2.0 ? 0.01 : 0.0, 0.0));
            };
            fixture.fold(fixture.u, slid, 0.004, seed);
            fixture.problem->begin_increment(2.0, fixture.u);
            const auto direction = fixture.layout->new_vector();
            {
              VecArray values(direction);
              for (std::int32_t node = 0; node < fixture.mesh.num_owned; ++node)
                for (int c = 0; c < dim; ++c)
                  values[node * dim + c] = noise(fixture.reference(node), c, 17);
            }
            double range = 1e-3;
            while (range > 1e-5 && !is_smooth(fixture, direction, range))
              range *= 0.3;
            if (range <= 1e-5) continue;
            found = true;
            check_taylor(fixture, direction, range);
          }
          CHECK(found);
        }
}

TEST_CASE("self contact: the same on any number of ranks") {
  for (const int dim : {2, 3}) {
    CAPTURE(dim);
    double energies[2], areas[2], norms[2];
    int at = 0;
    for (const MPI_Comm comm : {PETSC_COMM_WORLD, PETSC_COMM_SELF}) {
      Fixture fixture({.strip = strip_of(dim, 1), .law = FrictionLaw(Coulomb{.mu = 0.3}), .comm = comm});
      fixture.begin(hairpin(4.0, 0.1, -0.02), 0.004);
      fixture.problem->commit(fixture.u);
      fixture.fold(fixture.u, hairpin(4.0, 0.1, -0.025), 0.004);
      fixture.problem->begin_increment(2.0, fixture.u);
      const auto residual = fixture.layout->new_vector();
      fixture.problem->residual(fixture.u, residual);
      const auto state = fixture.problem->state_at(fixture.u);
      energies[at] = sum(fixture.form->stored_energy(state), comm);
      areas[at] = fixture.form->totals(state).area;
      norms[at++] = norm(residual);
    }
    CHECK(energies[0] == doctest::Approx(energies[1]).epsilon(1e-12));
    CHECK(areas[0] == doctest::Approx(areas[1]).epsilon(1e-12));
    CHECK(norms[0] == doctest::Approx(norms[1]).epsilon(1e-12));
    CHECK(norms[0] > 0.1);
  }
}

TEST_CASE("contact between all: bodies that overlap from the start are in contact, in both kinematics") {
  for (const int dim : {2, 3})
    for (const auto kinematics : {Kinematics::Small, Kinematics::Finite}) {
      CAPTURE(dim);
      CAPTURE(int(kinematics));
      auto mesh = distribute_mesh(PETSC_COMM_WORLD, two_blocks(PETSC_COMM_WORLD, dim, 3, 4, -0.02), {}, 0);
      name_exterior(mesh);
      const DofLayout layout(mesh, {}, {});
      ContactPair pair{.name = "all",
                       .slave = exterior_name,
                       .master = std::string(exterior_name),
                       .enforcement = Penalty{},
                       .projection = ClosestPoint{},
                       .kinematics = kinematics,
                       .space = dim == 3 ? Space::Solid : Space::PlaneStrain,
                       .stiffness = {stiffness, stiffness}};
      pair.search_distance = 0.2;
      auto contact = std::make_unique<ContactForm>(layout, std::move(pair));
      auto* form = contact.get();
      std::vector<std::unique_ptr<Form>> forms;
      forms.push_back(std::move(contact));
      Problem problem(layout, std::move(forms), {});
      const auto u = layout.new_vector();
      problem.begin_increment(1.0, u);
      const auto residual = layout.new_vector();
      problem.residual(u, residual);
      const auto totals = form->totals(problem.state_at(u));
      CHECK(totals.area == doctest::Approx(1.0).epsilon(1e-9)); // of each side one half
      CHECK(totals.largest_penetration == doctest::Approx(0.02 * 4).epsilon(1e-9));
      CHECK(totals.max_pressure == doctest::Approx(0.02 * stiffness / mean_size(*form)).epsilon(1e-9));
    }
}
