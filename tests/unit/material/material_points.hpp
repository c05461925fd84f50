// Laws of every kind, random strains for them, and a driver that finds the lateral strain of a uniaxial test.
#pragma once

#include "material/bulk_material.hpp"

#include <Eigen/Dense>
#include <random>
#include <string>
#include <vector>

namespace amontons {

inline constexpr double G_of(const Elastic& elastic) { return elastic.young / (2 * (1 + elastic.poisson)); }

inline ElasticPlastic plastic(Hardening hardening) {
  return {.elastic = {100, 0.3}, .hardening = std::move(hardening), .kinematic = {}, .rate = {}};
}

struct SamplePlastic {
  std::string name;
  ElasticPlastic material;
};

/// Every hardening, with and without kinematic hardening and rate; E = 100, yield stress near 1.
inline std::vector<SamplePlastic> sample_plastics() {
  ElasticPlastic kinematic = plastic(LinearHardening{1, 2}), viscous = plastic(SwiftHardening{2, 0.02, 0.2});
  kinematic.kinematic = Prager{4};
  viscous.rate = Perzyna{0.5, 3};
  ElasticPlastic both = plastic(VoceHardening{1, 0.8, 12, 0.3});
  both.kinematic = Prager{4};
  both.rate = Perzyna{0.5, 1};
  return {{"perfect", plastic(LinearHardening{1, 0})},
          {"linear", plastic(LinearHardening{1, 5})},
          {"swift", plastic(SwiftHardening{2, 0.02, 0.2})},
          {"voce", plastic(VoceHardening{1, 0.8, 12, 0.3})},
          {"table", plastic(TabulatedHardening{{0, 0.01, 0.1, 0.5}, {1, 1.2, 1.7, 1.9}})},
          {"linear, prager", kinematic},
          {"swift, perzyna", viscous},
          {"voce, prager, perzyna", both}};
}

struct SampleFinite {
  std::string name;
  FiniteLaw law;
};

inline std::vector<SampleFinite> sample_hyperelastics() {
  const Elastic rubber{10, 0.3}, tight{10, 0.4999};
  return {{"st_venant_kirchhoff", StVenantKirchhoff{rubber}},
          {"neo_hookean", NeoHookean{rubber}},
          {"neo_hookean, nu = 0.4999", NeoHookean{tight}},
          {"mooney_rivlin", MooneyRivlin{1.2, 0.5, 9}},
          {"mooney_rivlin, nearly incompressible", MooneyRivlin{1.2, 0.5, 1e4}},
          {"hencky", Hencky{rubber}},
          {"hencky, nu = 0.4999", Hencky{tight}}};
}

inline std::vector<SampleFinite> sample_finite_laws() {
  auto laws = sample_hyperelastics();
  for (const auto& [name, material] : sample_plastics())
    laws.push_back({"finite " + name, FinitePlastic{material}});
  return laws;
}

class RandomStrain {
 public:
  explicit RandomStrain(unsigned seed) : random_(seed) {}
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  /// Entries between -size and size.
  Tensor tensor(double size) {
    return Tensor::NullaryExpr([&] { return between(-size, size); });
  }
  Strain<3> strain(double size) {
    return Strain<3>::NullaryExpr([&] { return between(-size, size); });
  }
  /// exp(A) turned: det F > 0 for any size.
  Tensor gradient(double size) {
    const Tensor A = tensor(size);
    return rotation() * exp_symmetric(0.5 * (A + A.transpose()));
  }
  Tensor rotation() {
    return Eigen::Quaterniond(between(-1, 1), between(-1, 1), between(-1, 1), between(-1, 1))
        .normalized()
        .toRotationMatrix();
  }

 private:
  std::mt19937 random_;
};

/// A point of a law with its accepted state, which `accept` moves on.
template <class Law>
class MaterialPoint {
 public:
  explicit MaterialPoint(Law law) : law_(std::move(law)), old_(state_names(law_).size()), new_(old_.size()) {
    initial_state(law_, old_);
  }
  auto respond(const auto& strain, double dt = 1) { return amontons::respond(law_, {.dt = dt}, strain, old_, new_); }
  auto accept(const auto& strain, double dt = 1) {
    const auto response = respond(strain, dt);
    old_ = new_;
    return response;
  }
  PiolaTangent tangent(const Tensor& F, double dt = 1) const {
    PiolaTangent A;
    outcome_ = amontons::tangent(law_, {.dt = dt}, F, old_, A);
    return A;
  }
  Moduli<3> moduli(const Strain<3>& strain, double dt = 1) const {
    Moduli<3> C;
    outcome_ = amontons::tangent(law_, {.dt = dt}, strain, old_, C);
    return C;
  }
  /// Of the last tangent.
  PointOutcome outcome() const { return outcome_; }
  const std::vector<double>& state() const { return old_; }
  double p() const { return old_[0]; }

 private:
  Law law_;
  std::vector<double> old_, new_;
  mutable PointOutcome outcome_ = PointOutcome::Solved;
};

/// Work of the stress on a change of small strain, and of P on a change of F.
inline double work(const SmallResponse& response, const Strain<3>& change) { return response.stress.dot(change); }
inline double work(const FiniteResponse& response, const Tensor& change) { return contract(response.piola, change); }

/// One increment of a bar in x without lateral stress: Newton's method for the two lateral stretches, from `guess`.
struct BarStep {
  FiniteResponse response;
  Tensor F;
  int iterations;
};
inline BarStep pull_bar(MaterialPoint<FiniteLaw>& point, double stretch, const Tensor& guess, double dt = 1) {
  Tensor F = guess;
  F(0, 0) = stretch;
  for (int i = 0; i < 50; ++i) {
    const auto response = point.respond(F, dt);
    const Eigen::Vector2d residual(response.piola(1, 1), response.piola(2, 2));
    const PiolaTangent A = point.tangent(F, dt);
    if (residual.norm() < 1e-13 * A.norm()) return {point.accept(F, dt), F, i};
    Eigen::Matrix2d K;
    K << A(4, 4), A(4, 8), A(8, 4), A(8, 8);
    const Eigen::Vector2d change = K.inverse() * residual;
    F(1, 1) -= change[0];
    F(2, 2) -= change[1];
  }
  return {{.outcome = PointOutcome::NotConverged}, F, 50};
}

} // namespace amontons
